// Runs first, in old syntax on purpose. Starts the program if the address leads to it; otherwise the first page stays.
// Reports a browser that is too old for the program's modules, and modules that cannot be loaded. Once they run, main.js
// takes over.
(function () {
  var TOO_OLD = "This browser cannot run Tilescope. It knows too little of modern JavaScript.";
  var NOT_LOADED =
    "A part of the page cannot be loaded. The network or the server may be at fault, or a frame that allows too little.";
  var MODULES = [
    "{{asset:tilescope.js}}",
    "{{asset:embed.js}}",
    "{{asset:lesson.js}}",
    "{{asset:load.js}}",
    "{{asset:missing.js}}",
    "{{asset:offline.js}}",
    "{{asset:sheets.js}}",
    "{{asset:view.js}}",
    "{{asset:main.js}}",
  ];
  var root = document.documentElement;
  var siteStyle = document.getElementById("site-style");
  var style = document.getElementById("program-style");
  // Every fragment is a link into the program, and a frame is made for a player. Of the rest of the address only the
  // program's own keys count, since feeds and mails add keys of theirs to links.
  function leadsToProgram() {
    var keys = /[?&](play|embed|origin|text|talk|display|engine)(=|&|$)/;
    return location.hash.length > 1 || window.parent !== window || keys.test(location.search);
  }
  function add(kind, settings) {
    var made = document.createElement(kind);
    for (var name in settings) {
      made[name] = settings[name];
    }
    document.head.appendChild(made);
  }
  // Puts the program's part of the page in the place of the first page.
  function mount() {
    var parts = document.importNode(document.getElementById("program").content, true);
    document.body.textContent = "";
    document.body.appendChild(parts);
    siteStyle.disabled = true;
    if (isOld) {
      show("missing", TOO_OLD);
    } else {
      add("script", { type: "module", src: MODULES[MODULES.length - 1] });
    }
  }
  function mountStyled() {
    if (style.sheet) {
      mount();
    } else {
      style.onload = style.onerror = mount;
    }
  }
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
  var isOld = !("noModule" in document.createElement("script"));
  if (!leadsToProgram()) {
    window.addEventListener("hashchange", function () {
      if (leadsToProgram()) {
        location.reload();
      }
    });
    return;
  }
  // The style of the first page hides it until the program's part is there.
  root.setAttribute("data-waits", "");
  style.media = "all";
  if (!isOld) {
    MODULES.forEach(function (address) {
      add("link", { rel: "modulepreload", href: address });
    });
  }
  document.addEventListener("DOMContentLoaded", mountStyled);
  window.addEventListener(
    "error",
    function (event) {
      if (root.hasAttribute("data-runs")) {
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
