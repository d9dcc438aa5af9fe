// A line over the states of a load case, the present one marked.
function chart(history, frames, now, name, unit) {
  const space = "http://www.w3.org/2000/svg";
  const draw = (kind, attributes, text) => {
    const element = document.createElementNS(space, kind);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text) element.textContent = text;
    return element;
  };
  const [width, height, left, below] = [420, 130, 62, 30];
  const [from, to] = [Math.min(...frames.values), Math.max(...frames.values)];
  const along = (value) => left + ((value - from) / (to - from || 1)) * (width - left - 8);
  const values = history.map(([, value]) => value);
  const low = Math.min(0, ...values);
  const high = Math.max(0, ...values) || 1;
  const up = (value) => 8 + ((high - value) / (high - low)) * (height - below - 8);
  const svg = draw("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svg.setAttribute("aria-label",
    `${name} over ${frames.label}, from ${written(values[0], unit)} to `
    + `${written(values.at(-1), unit)}, largest ${written(Math.max(...values), unit)}`);
  const points = history.map(([at, value]) =>
    `${along(frames.values[at]).toFixed(1)},${up(value).toFixed(1)}`);
  svg.append(
    draw("path", { d: `M${left} 8V${height - below}H${width - 8}`, class: "axis" }),
    draw("polyline", { points: points.join(" ") }),
    draw("text", { x: left - 6, y: 14, "text-anchor": "end" }, written(high)),
    draw("text", { x: left - 6, y: height - below, "text-anchor": "end" }, written(low)),
    draw("text", { x: left, y: height - 12 }, written(from)),
    draw("text", { x: width - 8, y: height - 12, "text-anchor": "end" },
      `${written(to, frames.unit)}`),
    draw("text", { x: (left + width) / 2, y: height - 12, "text-anchor": "middle" },
      `${frames.label}; ${name} [${unit}]`),
  );
  const present = history.find(([at]) => at === now);
  if (present) {
    const [x, y] = [along(frames.values[now]), up(present[1])];
    svg.append(draw("circle", { cx: x, cy: y, r: 4 }));
  }
  return svg;
}
