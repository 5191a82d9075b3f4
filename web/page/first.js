// Runs first, in old syntax on purpose: reports a browser that is too old for the page's modules, and modules that
// cannot be loaded. Once they run, main.js takes over.
(function () {
  var TOO_OLD = "This browser cannot run Tilescope. It knows too little of modern JavaScript.";
  var NOT_LOADED =
    "A part of the page cannot be loaded. The network or the server may be at fault, or a frame that allows too little.";
  function show(id, reason) {
    document.getElementById("loading").hidden = true;
    document.getElementById(id).hidden = false;
    tell(reason);
  }
  // As in embed.js: sent to the page around this one, if its origin is the named one or this page's own.
  function tell(reason) {
    try {
      var asked = new URLSearchParams(location.search);
      var named = asked.get("origin");
      // Only an origin is accepted, so "*" is not.
      var address = named && new URL(named);
      var origin = address && address.href === address.origin + "/" ? address.origin : location.origin;
      if (window.parent !== window && asked.get("embed")) {
        window.parent.postMessage({ tilescope: 1, event: "failed", error: reason }, origin);
      }
    } catch (error) {
      // The reason is still shown on this page.
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
