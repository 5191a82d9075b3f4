// @ts-check
// The service worker, which keeps the page for times without a network, and the notice of a new version.

import { offer } from "./{{asset:sheets.js}}";

/** Keeps the page for later visits. What goes wrong here takes nothing from this one. */
export async function keepOffline() {
  if (!("serviceWorker" in navigator) || !window.isSecureContext) {
    return;
  }
  try {
    const registration = await navigator.serviceWorker.register("./sw.js", { scope: "./", updateViaCache: "none" });
    watch(registration);
  } catch (error) {
    console.warn("Tilescope will not work offline:", error);
  }
}

/** @param {ServiceWorkerRegistration} registration */
function watch(registration) {
  const follow = (/** @type {ServiceWorker | null} */ coming) =>
    coming?.addEventListener("statechange", () => {
      // The first one replaces none.
      if (coming.state === "installed" && registration.active) {
        offer(() => change(registration));
      }
    });
  if (registration.waiting && registration.active) {
    offer(() => change(registration));
  }
  // The browser may have begun to fetch it while this page was loading.
  follow(registration.installing);
  registration.addEventListener("updatefound", () => follow(registration.installing));
  // Another tab has changed to the new version; this one still runs the old.
  navigator.serviceWorker.addEventListener("controllerchange", () => offer(() => location.reload()));
}

/** Lets the waiting version take over and loads it; the address, with what is shown, stays. */
function change(/** @type {ServiceWorkerRegistration} */ registration) {
  const { waiting } = registration;
  if (!waiting) {
    location.reload();
    return;
  }
  waiting.addEventListener("statechange", () => {
    if (waiting.state === "activated") {
      location.reload();
    }
  });
  waiting.postMessage({ tilescope: "change" });
}
