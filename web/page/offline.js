// @ts-check
// Registers the service worker, which stores the page for use without a network, and shows the notice of a new version.

import { offer } from "./{{asset:sheets.js}}";

/** Stores the page for later visits. Failures do not affect this visit. */
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
      // The first version replaces no other.
      if (coming.state === "installed" && registration.active) {
        offer(() => change(registration));
      }
    });

  if (registration.waiting && registration.active) {
    offer(() => change(registration));
  }

  // The browser may have begun to fetch a new version while this page was loading.
  follow(registration.installing);
  registration.addEventListener("updatefound", () => follow(registration.installing));

  // Another tab has changed to the new version; this one still runs the old one.
  navigator.serviceWorker.addEventListener("controllerchange", () => offer(() => location.reload()));
}

/** Activates the waiting version and reloads; the address, which holds the view, stays. */
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
