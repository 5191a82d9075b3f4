// Caches one version of the page with all its files, which are then served without the network. A newer version waits
// until the page that shows the old one requests the change, so that files of two versions are never mixed.

const VERSION = "{{version}}";
const FILES = {{precache}};

const PREFIX = "tilescope-";
// Caches belong to an origin, which may hold other copies of the page under other paths.
const CACHE = `${PREFIX}${new URL(registration.scope).pathname}-${VERSION}`;
const HASHED = /-[0-9a-f]{12}\.[a-z]+$/;
const NAMES = /[\w.-]+-[0-9a-f]{12}\.[a-z]+/g;

const address = (path) => new URL(path, registration.scope).href;
const page = address("./");
/** An entry in the cache of every version that has served pages; other versions were fetched but not used yet. */
const SERVED = address("served");

self.addEventListener("install", (event) => event.waitUntil(keep()));
self.addEventListener("activate", (event) => event.waitUntil(forgetOthers()));
self.addEventListener("message", (event) => {
  if (event.data?.tilescope === "change") {
    self.skipWaiting();
  }
});
self.addEventListener("fetch", (event) => {
  const { request } = event;
  const url = new URL(request.url);
  if (request.method !== "GET" || !request.url.startsWith(registration.scope)) {
    return;
  }
  const plain = url.origin + url.pathname;
  if (request.mode === "navigate" && (plain === page || plain === address("index.html"))) {
    event.respondWith(kept(page, request));
  } else if (HASHED.test(plain) || plain === address("manifest.webmanifest")) {
    event.respondWith(kept(plain, request));
  }
});

/** Caches all files or none, because an incomplete version is useless. */
async function keep() {
  // After a rollback this version may be the one that a tab shows.
  const wasKept = await caches.has(CACHE);
  const cache = await caches.open(CACHE);
  const done = await Promise.allSettled(FILES.map((path) => keepOne(cache, path)));
  const failed = done.find(({ status }) => status === "rejected");
  if (failed) {
    if (!wasKept) {
      await caches.delete(CACHE);
    }
    throw failed.reason;
  }
}

/** Fetches a file unless an earlier version has it: names identify contents. */
async function keepOne(cache, path) {
  const url = address(path);
  const earlier = HASHED.test(path) ? await caches.match(url) : undefined;
  await cache.put(url, earlier ?? (await fetched(path, url)));
}

/** Uses the browser's cache for files with a hash in their name, whose content cannot change. */
async function fetched(path, url) {
  const response = await fetch(new Request(url, { cache: HASHED.test(path) ? "default" : "reload" }));
  if (!response.ok) {
    throw new Error(`the server answered ${response.status} when asked for ${path}`);
  }
  if (url === page) {
    await checkPage(response.clone());
  } else if (/^text\/html\b/i.test(response.headers.get("Content-Type") ?? "")) {
    // Some servers send their page for files that they do not have.
    throw new Error(`the server answered with a page when asked for ${path}`);
  }
  // Browsers refuse a redirected response for a page.
  return response.redirected ? new Response(response.body, { headers: response.headers }) : response;
}

/** Refuses a page that refers to other files: that of another version, or of a network's sign-in. */
async function checkPage(response) {
  const names = (await response.text()).match(NAMES) ?? [];
  if (names.length === 0 || !names.every((name) => FILES.includes(name))) {
    throw new Error("the server answered with a page of another version");
  }
}

/** Removes the caches of this page's older versions, except the last one that served pages: another tab may still show it. */
async function forgetOthers() {
  const start = CACHE.slice(0, -VERSION.length);
  const others = (await caches.keys()).filter((name) => name.startsWith(start) && name !== CACHE);
  const served_ms = await Promise.all(others.map(servedLast));
  const before = others[served_ms.lastIndexOf(Math.max(...served_ms))];
  await Promise.all(others.filter((name) => name !== before).map((name) => caches.delete(name)));
  await (await caches.open(CACHE)).put(SERVED, new Response(String(Date.now())));
}

/** Returns when a cache's version last began to serve pages; 0 if it never did. */
async function servedLast(cacheName) {
  const mark = await caches.match(SERVED, { cacheName });
  return mark ? Number(await mark.text()) : 0;
}

async function kept(url, request) {
  const cache = await caches.open(CACHE);
  const found = (await cache.match(url)) ?? (HASHED.test(url) ? await caches.match(url) : undefined);
  return found ?? fetch(request);
}
