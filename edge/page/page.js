// What changes is fetched anew every ten seconds; without a script the page stays as it was opened.
"use strict";
(() => {
  const live = document.getElementById("live");
  if (!live) return;
  const renew = async () => {
    if (document.hidden) return;
    try {
      const answer = await fetch(".", { cache: "no-store", redirect: "error" });
      if (!answer.ok) throw new Error(answer.status);
      const page = new DOMParser().parseFromString(await answer.text(), "text/html");
      const fresh = page.getElementById("live");
      const focused = document.activeElement?.closest("#live [tabindex]");
      if (fresh && !focused) live.replaceChildren(...fresh.childNodes);
      document.body.classList.remove("stale");
    } catch (error) {
      document.body.classList.add("stale");
    }
  };
  setInterval(renew, 10000);
})();
