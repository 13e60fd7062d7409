// Colours of Okabe and Ito, distinguishable with any colour vision, light and dark.

const PALETTES = {
  light: {
    paper: 0xffffff, grid: 0xdfe2e6, line: 0xb9bec6, rod: 0x6b6f76, tyre: 0x33363b, spoke: 0x9aa0a8, mark: 0x33363b,
    disc: 0x56b4e9, body: 0xe69f00, mass: 0x33363b, point: 0x0072b2, spring: 0xcc79a7, trace: 0x009e73,
    reaction: 0xd55e00, load: 0x0072b2, weight: 0xcc79a7, x: 0xd55e00, y: 0x009e73, z: 0x0072b2, plot: "#0072b2",
  },
  dark: {
    paper: 0x16181c, grid: 0x2b2f36, line: 0x454b55, rod: 0xb9bdc4, tyre: 0xd0d3d8, spoke: 0x70757e, mark: 0xffffff,
    disc: 0x56b4e9, body: 0xe69f00, mass: 0xe6e6e6, point: 0x56b4e9, spring: 0xcc79a7, trace: 0x009e73,
    reaction: 0xd55e00, load: 0xf0e442, weight: 0xcc79a7, x: 0xe69f00, y: 0x009e73, z: 0x56b4e9, plot: "#56b4e9",
  },
};

/** Red, green and blue of a colour 0xrrggbb, from 0 to 1. */
const channels = (colour) => [16, 8, 0].map((shift) => ((colour >> shift) & 255) / 255);

/** The colours in use; followers are called when they change. */
const colours = {
  theme: matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
  followers: [],
  get now() {
    return PALETTES[this.theme];
  },
  follow(repaint) {
    this.followers.push(repaint);
    repaint(this.now);
  },
  use(theme) {
    this.theme = theme;
    document.documentElement.dataset.theme = theme;
    for (const repaint of this.followers) repaint(this.now);
  },
};
