// The page embedded in another one, which sends it one motion after the other.

/** Shows the motions sent by the embedding page; all have the same parts. */
function listen() {
  let player = null;
  colours.use(colours.theme);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", ({ matches }) => {
    colours.use(matches ? "dark" : "light");
  });
  addEventListener("message", ({ source, data }) => {
    if (source !== parent) return;
    take(data);
    if (player) player.renew();
    else player = start();
    parent.postMessage({ shown: data.stamp }, "*");
  });
  parent.postMessage({ ready: true }, "*");
}
