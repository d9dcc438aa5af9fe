// Colour scales: few colours of the page's data, in between by interpolation.

const LEVELS = 256;

function parsed(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

// LEVELS times red, green, blue, opaque.
function ramp(hexes) {
  const colours = hexes.map(parsed);
  const table = new Uint8Array(4 * LEVELS);
  for (let level = 0; level < LEVELS; level++) {
    const place = (level / (LEVELS - 1)) * (colours.length - 1);
    const below = Math.min(Math.floor(place), colours.length - 2);
    for (let part = 0; part < 3; part++) {
      const [from, to] = [colours[below][part], colours[below + 1][part]];
      table[4 * level + part] = Math.round(from + (to - from) * (place - below));
    }
    table[4 * level + 3] = 255;
  }
  return table;
}

// What is shown of a field: values between low and high by a ramp, grey up to `open`.
// {ramp, low, high, open, grey}
function level(scale, value) {
  const share = (value - scale.low) / (scale.high - scale.low);
  return Math.max(0, Math.min(LEVELS - 1, Math.round(share * (LEVELS - 1))));
}
