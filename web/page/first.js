// Runs before all else, in old syntax on purpose: says so where the browser knows too little for the page's modules, or
// where one of them cannot be had. Once they run, main.js takes over.
(function () {
  var TOO_OLD = "This browser cannot run Tilescope. It knows too little of modern JavaScript.";
  var NOT_LOADED =
    "A part of the page cannot be loaded. The network or the server may be at fault, or a frame that allows too little.";
  function show(id, reason) {
    document.getElementById("loading").hidden = true;
    document.getElementById(id).hidden = false;
    tell(reason);
  }
  // As embed.js would: to the page around this one, if its origin is the one that is named, or else this one's own.
  function tell(reason) {
    try {
      var asked = new URLSearchParams(location.search);
      var named = asked.get("origin");
      // Nothing else than an origin, so not "*" either.
      var address = named && new URL(named);
      var origin = address && address.href === address.origin + "/" ? address.origin : location.origin;
      if (window.parent !== window && asked.get("embed")) {
        window.parent.postMessage({ tilescope: 1, event: "failed", error: reason }, origin);
      }
    } catch (error) {
      // It is shown all the same.
    }
  }
  if (!("noModule" in document.createElement("script"))) {
    document.addEventListener("DOMContentLoaded", function () {
      show("missing", TOO_OLD);
    });
    return;
  }
  window.addEventListener(
    "error",
    function (event) {
      if (document.documentElement.hasAttribute("data-runs")) {
        return;
      }
      if (event.error instanceof SyntaxError) {
        show("missing", TOO_OLD);
      } else if (event.error || event.target.tagName === "SCRIPT") {
        document.getElementById("failure-text").textContent = NOT_LOADED;
        document.getElementById("failure-reload").onclick = function () {
          location.reload();
        };
        show("failure", NOT_LOADED);
      }
    },
    true
  );
})();
