// Keeps one version of the page: all of its files, which are then served without asking the network. A newer version
// waits until the page that shows the old one asks for the change, so that files of two versions never meet.

const VERSION = "{{version}}";
const FILES = {{precache}};

const PREFIX = "tilescope-";
// Caches belong to an origin, on which other copies of the page may lie under other paths.
const CACHE = `${PREFIX}${new URL(registration.scope).pathname}-${VERSION}`;
const HASHED = /-[0-9a-f]{12}\.[a-z]+$/;

const address = (path) => new URL(path, registration.scope).href;
const page = address("./");

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

/** Fetches what the versions before have not: a file's name says what it holds. */
async function keep() {
  const cache = await caches.open(CACHE);
  const one = async (path) => {
    const url = address(path);
    const earlier = HASHED.test(path) ? await caches.match(url) : undefined;
    await cache.put(url, earlier ?? (await fetched(path, url)));
  };
  await Promise.all(FILES.map(one));
}

/** What the page has just fetched is not fetched again: a hashed name never holds anything else. */
async function fetched(path, url) {
  const response = await fetch(new Request(url, { cache: HASHED.test(path) ? "default" : "reload" }));
  if (!response.ok) {
    throw new Error(`the server answered ${response.status} when asked for ${path}`);
  }
  // A page may not be answered with what was redirected.
  return response.redirected ? new Response(response.body, { headers: response.headers }) : response;
}

/** Removes the caches of this page's older versions but the one before: another tab may still show it. */
async function forgetOthers() {
  const start = CACHE.slice(0, -VERSION.length);
  const old = (await caches.keys()).filter((name) => name.startsWith(start) && name !== CACHE);
  await Promise.all(old.slice(0, -1).map((name) => caches.delete(name)));
}

async function kept(url, request) {
  const cache = await caches.open(CACHE);
  const found = (await cache.match(url)) ?? (HASHED.test(url) ? await caches.match(url) : undefined);
  return found ?? fetch(request);
}
