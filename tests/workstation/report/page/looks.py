"""What a page looks like, found out in the browser: what hangs over an edge, what is hard to read,
what is cut off.

Each function gives a list of what is wrong, for people; empty is good. `page` is a browser.Page.
"""

LARGE_TEXT_PX = 24  # from here on WCAG asks for a contrast of 3, else of 4.5


def settle(page):
    """Until what was changed is drawn."""
    page.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def off_the_screen(page):
    """Elements beyond the window or their card that no scroller of their own holds, and the
    window's own scrolling."""
    return page.run("""(() => {
      const inScroller = (element) =>
        element.closest(".wide") !== null && !element.matches(".wide");
      const found = [...document.body.querySelectorAll("*")].filter((element) => {
        const box = element.getBoundingClientRect(), card = element.closest(".card");
        const right = card ? Math.min(innerWidth, card.getBoundingClientRect().right) : innerWidth;
        return box.width > 0 && !inScroller(element) && (box.right > right + .5 || box.left < -.5);
      }).map((element) =>
        `${element.tagName}#${element.id}.${element.getAttribute("class")} is off the screen`);
      const width = document.documentElement.scrollWidth;
      return width > innerWidth ? [...found, `the page is ${width} px wide`] : found;
    })()""")


def low_contrast(page):
    """Texts that stand out from what is behind them by less than WCAG 2 AA asks for."""
    return page.run("""(() => {
      const parse = (text) => {
        const scale = text.startsWith("color(srgb") ? 255 : 1;  // what color-mix() gives
        const [red, green, blue, alpha = 1] = text.match(/[\\d.]+/g).map(Number);
        return {rgb: [red, green, blue].map((c) => scale * c), alpha};
      };
      const behind = (element) => {
        for (let e = element; e; e = e.parentElement) {
          const {rgb, alpha} = parse(getComputedStyle(e).backgroundColor);
          if (alpha === 1) return rgb;
        }
        return matchMedia("(prefers-color-scheme: dark)").matches ? [0, 0, 0] : [255, 255, 255];
      };
      const luminance = (rgb) => {
        const [r, g, b] = rgb.map((c) => c / 255 <= .04045 ? c / 255 / 12.92
                                  : ((c / 255 + .055) / 1.055) ** 2.4);
        return .2126 * r + .7152 * g + .0722 * b;
      };
      const contrast = (a, b) => {
        const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
        return (high + .05) / (low + .05);
      };
      const found = [];
      for (const element of document.body.querySelectorAll("*")) {
        const own = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE
                                                 && node.data.trim());
        if (!own || element.closest("script, noscript, option, [disabled]")
            || !element.checkVisibility()) continue;
        const style = getComputedStyle(element);
        const ink = parse(element instanceof SVGElement ? style.fill : style.color).rgb;
        const ratio = contrast(ink, behind(element));
        const least = parseFloat(style.fontSize) >= %d ? 3 : 4.5;
        if (ratio < least) found.push(
          `${element.textContent.trim().slice(0, 40)}: contrast ${ratio.toFixed(2)}`);
      }
      return found;
    })()""" % LARGE_TEXT_PX)


def cut_off(page):
    """Texts of elements and drawings that are wider than what holds them."""
    return page.run("""(() => {
      const found = [];
      for (const element of document.body.querySelectorAll("*")) {
        const style = getComputedStyle(element);
        if (["hidden", "clip"].includes(style.overflowX)
            && element.scrollWidth > element.clientWidth + 1 &&
            element.innerText?.trim()) {
          found.push(element.textContent.trim().slice(0, 40));
        }
      }
      for (const text of document.querySelectorAll("svg text")) {
        const box = text.getBoundingClientRect();
        const frame = text.closest("svg").getBoundingClientRect();
        if (box.left < frame.left - 1 || box.right > frame.right + 1) found.push(text.textContent);
      }
      return found;
    })()""")


def cut_off_in_canvases(page):
    """Texts that reach beyond the canvas that they are drawn on; of a page of a run."""
    return page.run("""(() => {
      const found = [];
      const watch = (proto) => {
        const real = proto.fillText;
        proto.fillText = function (text, x, y, most) {
          const width = Math.min(this.measureText(text).width, most ?? Infinity);
          const at = this.getTransform();
          const before = {center: width / 2, right: width, end: width}[this.textAlign] ?? 0;
          const ends = [x - before, x - before + width]
            .map((end) => at.transformPoint({x: end, y}).x);
          if (Math.abs(at.b) < .01
              && (Math.min(...ends) < -1 || Math.max(...ends) > this.canvas.width + 1)) {
            found.push(`${this.canvas.id || this.canvas.getAttribute("aria-label")}: ${text}`);
          }
          return real.apply(this, arguments);
        };
        return () => { proto.fillText = real; };
      };
      const restore = watch(CanvasRenderingContext2D.prototype);
      redrawCharts();
      page.map.paint();
      restore();
      return [...new Set(found)];
    })()""")


def not_read_aloud(page):
    """What somebody who hears the page would miss: a step of headings, heads of tables, words for
    pictures."""
    return page.run("""(() => {
      const found = [];
      const say = (element, text) =>
        found.push(
          `${element.tagName}#${element.id} ${element.textContent.trim().slice(0, 40)}: ${text}`);
      if (!document.documentElement.lang || !document.title) found.push("no language or no title");
      let level = 0;
      for (const heading of document.querySelectorAll("h1, h2, h3, h4, h5, h6")) {
        const own = Number(heading.tagName[1]);
        if (own > level + 1) say(heading, `follows h${level}`);
        level = own;
      }
      for (const once of ["h1", "main"]) {
        if (document.querySelectorAll(once).length !== 1) found.push(`not one ${once}`);
      }
      for (const table of document.querySelectorAll("table")) {
        const caption = table.caption ?? table.closest("figure")?.querySelector("figcaption");
        if (!caption?.textContent.trim()) say(table, "no caption");
        for (const head of table.querySelectorAll("th")) if (!head.scope) say(head, "no scope");
        for (const row of table.tBodies[0].rows) {
          if (!row.querySelector("th[scope=row]")) say(row, "no head");
        }
      }
      const labelled = (element) => element.getAttribute("aria-label") ||
        document.getElementById(element.getAttribute("aria-labelledby")?.split(" ")[0]);
      for (const picture of document.querySelectorAll("canvas, svg")) {
        if (picture.closest("[aria-hidden=true]") || picture.parentElement.closest("svg")) continue;
        if (picture.getAttribute("role") !== "img" || !labelled(picture)) say(picture, "no words");
      }
      for (const control of document.querySelectorAll("button, select, input, a")) {
        const text = control.matches("button, a") && control.textContent.trim();
        if (!text && !control.labels?.length && !labelled(control)) say(control, "no name");
      }
      return found;
    })()""")


def unseen_focus(page):
    """Links and controls that show no outline, or a thin one, when the keyboard is on them."""
    return page.run("""(() => {
      const found = [];
      for (const control of document.querySelectorAll("a[href], button, select, input")) {
        if (control.disabled || !control.checkVisibility()) continue;
        control.focus({focusVisible: true, preventScroll: true});
        const {outline, outlineStyle, outlineWidth} = getComputedStyle(control);
        if (document.activeElement !== control || outlineStyle === "none"
            || parseFloat(outlineWidth) < 2) {
          const text = control.textContent.trim().slice(0, 30);
          found.push(`${control.tagName}#${control.id} ${text}: ${outline}`);
        }
      }
      document.activeElement.blur();
      return found;
    })()""")
