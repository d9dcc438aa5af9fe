// Arrays that packing.py packed: inflated, summed up, scaled.

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Row after row, as {rows, columns, values}.
async function unpacked({ shape: [rows, columns], low, high, data }) {
  const total = rows * columns;
  const real = low.length > 0;
  const values = real ? new Float32Array(total) : new Uint32Array(total);
  if (!total) return { rows, columns, values };
  const bytes = await inflated(data);
  const width = bytes.length / total;
  const mask = width === 2 ? 0xffff : 0xffffffff;
  for (let column = 0; column < columns; column++) {
    const step = real ? (high[column] - low[column]) / 65535 : 1;
    let sum = 0;
    for (let row = 0; row < rows; row++) {
      let difference = 0;
      for (let byte = 0; byte < width; byte++) {
        difference |= bytes[byte * total + column * rows + row] << (8 * byte);
      }
      sum = ((sum + difference) & mask) >>> 0;
      values[row * columns + column] = real ? low[column] + step * sum : sum;
    }
  }
  return { rows, columns, values };
}

// A number with three significant digits, as the tables of the page write it.
function written(value, unit = "") {
  let text;
  if (!Number.isFinite(value)) text = "—";
  else if (value === 0) text = "0";
  else {
    const power = Math.floor(Math.log10(Math.abs(value)));
    if (power < -3 || power > 5) text = value.toExponential(2).replace("e+", "e");
    else text = String(Number(value.toPrecision(power > 2 ? power + 1 : 3)));
    text = text.replace(/^-/, "−");
  }
  return unit ? `${text} ${unit}` : text;
}
