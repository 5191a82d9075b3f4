// Runs before all else, in old syntax on purpose: says so where the browser knows too little for the page's modules, or
// where one of them cannot be had. Once they run, main.js takes over.
(function () {
  function show(id) {
    document.getElementById("loading").hidden = true;
    document.getElementById(id).hidden = false;
  }
  if (!("noModule" in document.createElement("script"))) {
    document.addEventListener("DOMContentLoaded", function () {
      show("missing");
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
        show("missing");
      } else if (event.error || event.target.tagName === "SCRIPT") {
        document.getElementById("failure-text").textContent =
          "A part of the page cannot be loaded. The network or the server may be at fault, or a frame that allows too little.";
        document.getElementById("failure-reload").onclick = function () {
          location.reload();
        };
        show("failure");
      }
    },
    true
  );
})();
