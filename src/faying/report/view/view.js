// What is chosen in the view, and what follows from it.

const QUANTITIES = {
  pressure: "contact pressure", gap: "gap", slip: "slip", error: "error of pressure",
};
const FACTORS = [0];
for (let power = 0; power < 7; power++) for (const digit of [1, 2, 5]) FACTORS.push(digit * 10 ** power);

async function startView(data) {
  const root = document.getElementById("view");
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const control = Object.fromEntries(
    ["case", "model", "quantity", "frame", "play", "apart", "stretch", "whole", "largest"]
      .map((name) => [name, part(name)]));
  const state = { picked: null, factor: 0, playing: null, drawn: 0, asked: 0, shown: 0 };
  const { bodies, contact } = data;

  const kept = new Map();
  const field = (number, model, name) => {
    const packed = data.cases[number].models[model]?.fields[name];
    if (!packed) return null;
    const key = `${number} ${model} ${name}`;
    if (!kept.has(key)) kept.set(key, unpacked(packed).then((one) => ({ ...packed, ...one })));
    return kept.get(key);
  };

  const part3 = {};
  for (const name of ["points", "owner", "triangles", "edges"]) {
    part3[name] = await unpacked(bodies[name]);
  }
  const sides = [];
  for (const { points, nodes, triangles, flat } of contact) {
    sides.push({
      points: await Promise.all(points.map(unpacked)),
      nodes: await Promise.all(nodes.map(unpacked)),
      triangles: await unpacked(triangles),
      flat: await unpacked(flat),
    });
  }
  const counts = sides.map(({ flat }) => flat.rows);
  const firsts = counts.map((_, number) =>
    counts.slice(0, number).reduce((sum, count) => sum + count, 0));

  let stage = null;
  try {
    // Asked first, for three.js complains in the console where there is none.
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("no WebGL");
    stage = new Stage(part("canvas"), part("labels"), data, part3, sides, () => {
      state.drawn += 1;
      root.dataset.drawn = state.drawn;
    });
  } catch {
    part("stage").hidden = true;
    part("no-webgl").hidden = false;
    for (const name of ["apart", "stretch", "whole"]) control[name].closest("label, button").hidden = true;
  }
  root.hidden = false;
  document.documentElement.classList.toggle("has-view", stage !== null);

  const maps = sides.map((side, number) => {
    const figure = document.createElement("figure");
    const canvas = document.createElement("canvas");
    const caption = document.createElement("figcaption");
    const { name, labels, over, period } = contact[number];
    const { length } = data.units;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `Map of ${name}: + and − zoom, arrows move, 0 shows all`);
    const [wide, tall] = [0, 1].map((axis) => {
      const along = side.flat.values.filter((_, at) => at % 2 === axis);
      return along.reduce((a, b) => Math.max(a, b), -Infinity)
        - along.reduce((a, b) => Math.min(a, b), Infinity);
    });
    canvas.style.aspectRatio = String(Math.min(Math.max(wide / tall || 1, 1), 6));
    const rest = `${name}: ${labels[0]} across, ${labels[1]} up, `
      + `${written(wide)} × ${written(tall, length)}`
      + (over ? ", faces that look opposite ways one over the other" : "");
    caption.textContent = rest;
    figure.append(canvas, caption);
    part("maps").append(figure);
    return new FieldMap(canvas, { ...side, period }, (value, x, y) => {
      caption.textContent = value === undefined || value === null
        ? rest
        : `${name}: ${written(value, unit())} at ${labels[0]} ${written(x, length)}, `
          + `${labels[1]} ${written(y, length)}`;
    }, (pair) => pick({ number, pair }));
  });

  function options(select, names, chosen) {
    select.replaceChildren(...names.map(([value, text]) => new Option(text, value)));
    if (names.some(([value]) => String(value) === String(chosen))) select.value = chosen;
    select.disabled = names.length < 2;
  }

  const chosen = () => ({
    number: Number(control.case.value), model: Number(control.model.value),
    quantity: control.quantity.value, frame: Number(control.frame.value),
  });

  function unit() {
    return { pressure: data.units.pressure, error: "%" }[chosen().quantity] ?? data.units.length;
  }

  function known(number, model) {
    const { models } = data.cases[number];
    const names = Object.keys(models[model].fields).filter((name) => name in QUANTITIES);
    if (model > 0 && models[0].fields.pressure && models[model].fields.pressure) names.push("error");
    return names;
  }

  function offer() {
    const number = Number(control.case.value);
    const one = data.cases[number];
    const name = control.model.selectedOptions[0]?.textContent;
    const there = one.models.map((model, at) => [at, model.name]).filter(([at]) => known(number, at).length);
    options(control.model, there, there.find(([, text]) => text === name)?.[0] ?? 0);
    const names = known(number, Number(control.model.value));
    options(control.quantity, names.map((each) => [each, QUANTITIES[each]]), control.quantity.value);
    const { values } = one.frames;
    control.frame.max = values.length - 1;
    if (state.case !== number) control.frame.value = firstFrame(one);
    state.case = number;
    part("frames").hidden = values.length < 2;
    if (values.length < 2) stop();
  }

  // Of static loads the full one, of cases in several states that with the largest pressure, by the reference.
  function firstFrame({ kind, models, frames }) {
    const pressure = models[0].fields.pressure;
    if (!pressure || kind === "static") return frames.values.length - 1;
    const [best] = pressure.high.reduce(
      ([place, top], high, at) => (high > top ? [at, high] : [place, top]), [0, -1]);
    return pressure.at[best];
  }

  // Values of all pairs in a frame {values, frame, low, high}; of errors in percent of the peak.
  async function read({ number, model, quantity, frame }) {
    const wanted = quantity === "error" ? "pressure" : quantity;
    const one = await field(number, model, wanted);
    if (!one) return null;
    const at = one.at.reduce((best, next, column) =>
      (Math.abs(next - frame) < Math.abs(one.at[best] - frame) ? column : best), 0);
    const base = model > 0 ? await field(number, 0, wanted) : null;
    const peak = data.cases[number].peak || 1;
    const value = (pair, column) => {
      const own = one.values[pair * one.columns + column];
      if (quantity !== "error") return own;
      return (100 * (own - base.values[pair * one.columns + column])) / peak;
    };
    let top = 0;
    for (let pair = 0; pair < one.rows; pair++) {
      for (let column = 0; column < one.columns; column++) {
        const size = value(pair, column);
        top = Math.max(top, quantity === "error" ? Math.abs(size) : size);
      }
    }
    // A method is shown by the scale of its reference, if that reaches further.
    if (base && quantity !== "error") for (const own of base.values) top = Math.max(top, own);
    top ||= 1;
    return {
      values: Float32Array.from({ length: one.rows }, (_, pair) => value(pair, at)),
      history: (pair) => one.at.map((place, column) => [place, value(pair, column)]),
      frame: one.at[at], top, signed: quantity === "error",
    };
  }

  async function show() {
    const wish = chosen();
    const ticket = (state.asked += 1);
    root.dataset.asked = ticket;
    const found = await read(wish);
    const moved = await (field(wish.number, wish.model, "displacement")
      ?? field(wish.number, 0, "displacement"));
    if (ticket !== state.asked || !found) return;
    const { top, signed, values } = found;
    const scale = {
      ramp: ramp(data.colours[wish.quantity]), low: signed ? -top : 0, high: top,
      grey: parsed(data.colours.open), open: wish.quantity === "pressure" ? 1e-4 * top : -Infinity,
    };
    state.found = found;
    const parts = counts.map((count, number) => values.subarray(firsts[number], firsts[number] + count));
    maps.forEach((map, number) => map.show(parts[number], scale));
    legend(scale, wish);
    labels(wish);
    if (stage) {
      // WebGL knows no infinity.
      stage.colour(parts, { ...scale, open: Math.max(scale.open, -1e30) });
      state.moved = moved;
      stretch(moved && displaced(moved, found.frame), wish.number);
      stage.mark(state.picked);
      if (!state.shown) stage.fit();
      else stage.draw();
    }
    describe(wish);
    root.dataset.shown = state.shown = ticket;
  }

  // A round factor that draws the largest displacement of a load case a twentieth of the size of
  // the model, until a reader chooses another.
  function stretch(displacement, number) {
    part("stretching").hidden = !displacement;
    if (displacement && state.stretched !== number && state.stretched !== "chosen") {
      const wanted = (0.05 * stage.size) / (state.moved.largest || Infinity);
      const places = FACTORS.filter((factor) => factor <= Math.max(wanted, 1));
      control.stretch.max = Math.min(places.length + 2, FACTORS.length - 1);
      control.stretch.value = places.length - 1;
      state.stretched = number;
    }
    const factor = FACTORS[Number(control.stretch.value)];
    part("factor").textContent = `× ${written(factor)}`;
    stage.place(Number(control.apart.value), displacement, factor);
  }

  function legend(scale, { number, quantity }) {
    const colours = data.colours[quantity].join(", ");
    part("ramp").style.background = `linear-gradient(to right, ${colours})`;
    part("low").textContent = written(scale.low);
    part("high").textContent = written(scale.high, unit());
    const what = { ...QUANTITIES, error: "error over the peak of the reference" }[quantity];
    part("what").textContent = quantity === "pressure" ? `${what}; grey: none` : what;
    part("grey").style.background = data.colours.open;
    part("grey").hidden = quantity !== "pressure";
    const { frames } = data.cases[number];
    const { frame } = state.found;
    part("instant").textContent = frames.label
      ? `${frames.label} ${written(frames.values[frame], frames.unit)}`
      : "";
    control.frame.setAttribute("aria-valuetext", part("instant").textContent);
  }

  function labels({ number, model }) {
    if (!stage) return;
    const forces = data.cases[number].models[model].bolts;
    for (const { name, label } of stage.bolts) {
      const force = forces[name]?.[Math.min(state.found.frame, forces[name].length - 1)];
      label.textContent = force === undefined ? name : `${name} ${written(force, data.units.force)}`;
    }
  }

  function place(picked) {
    const places = picked.point === undefined ? sides[picked.number].points[0] : part3.points;
    const from = 3 * (picked.point ?? picked.pair);
    const near = 1e-4 * (stage?.size ?? 1);
    const rounded = Array.from(places.values.subarray(from, from + 3), (x) =>
      written(Math.abs(x) < near ? 0 : x));
    return `(${rounded.join(", ")}) ${data.units.length}`;
  }

  function describe({ number, quantity }) {
    const { picked, found } = state;
    const text = part("picked");
    part("history").replaceChildren();
    if (!picked) return;
    const { frames } = data.cases[number];
    const when = frames.label ? ` at ${part("instant").textContent}.` : ".";
    if (picked.point !== undefined) {
      const history = state.moved ? travel(state.moved, picked.point) : [];
      const now = history.find(([frame]) => frame === found.frame);
      const { length } = data.units;
      text.textContent = `On a body, at ${place(picked)}`
        + (now ? `: displaced by ${written(now[1], length)}${when}` : ".");
      if (history.length > 1) {
        part("history").append(chart(history, frames, found.frame, "displacement", length));
      }
      return;
    }
    const pair = firsts[picked.number] + picked.pair;
    text.textContent = `${contact[picked.number].name} at ${place(picked)}: `
      + `${QUANTITIES[quantity]} ${written(found.values[pair], unit())}`
      + when;
    const history = found.history(pair);
    if (history.length > 1) {
      part("history").append(chart(history, frames, found.frame, QUANTITIES[quantity], unit()));
    }
  }

  function pick(picked) {
    state.picked = picked;
    stage?.mark(picked);
    stage?.draw();
    maps.forEach((map, number) => map.mark(picked?.number === number ? picked.pair : null));
    describe(chosen());
  }

  function pickLargest() {
    if (!state.found) return;
    const { values } = state.found;
    const best = values.reduce((top, value, pair) =>
      (Math.abs(value) > Math.abs(values[top]) ? pair : top), 0);
    const number = firsts.findLastIndex((first) => first <= best);
    if (number >= 0 && values.length) pick({ number, pair: best - firsts[number] });
  }

  function stop() {
    clearInterval(state.playing);
    state.playing = null;
    control.play.textContent = "Play";
  }

  control.play.addEventListener("click", () => {
    if (state.playing) return stop();
    control.play.textContent = "Stop";
    state.playing = setInterval(() => {
      const { max, value } = control.frame;
      control.frame.value = Number(value) < Number(max) ? Number(value) + 1 : 0;
      show();
    }, 150);
  });
  control.case.addEventListener("change", () => { offer(); show(); });
  control.model.addEventListener("change", () => { offer(); show(); });
  control.stretch.addEventListener("input", () => { state.stretched = "chosen"; });
  for (const name of ["quantity", "frame", "apart", "stretch"]) {
    control[name].addEventListener("input", () => show());
  }
  control.whole.addEventListener("click", () => stage?.fit());
  control.largest.addEventListener("click", pickLargest);
  if (stage) {
    const canvas = part("canvas");
    let pressed = null;
    canvas.addEventListener("pointerdown", (event) => { pressed = [event.offsetX, event.offsetY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (pressed && Math.hypot(event.offsetX - pressed[0], event.offsetY - pressed[1]) < 5) {
        pick(stage.at(event.offsetX, event.offsetY));
      }
      pressed = null;
    });
    const turns = {
      ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, 0.1, 1],
      ArrowDown: [0, -0.1, 1], "+": [0, 0, 1.15], "-": [0, 0, 1 / 1.15],
    };
    canvas.addEventListener("keydown", (event) => {
      if (event.key in turns) stage.turn(...turns[event.key]);
      else if (event.key === "0") stage.fit();
      else if (event.key === "Enter") {
        pick(stage.at(canvas.clientWidth / 2, canvas.clientHeight / 2));
      } else return;
      event.preventDefault();
    });
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => stage.draw());
  }

  // Those without a field had no room in the page.
  const there = data.cases.map(({ name, kind }, at) => [at, `${name} (${kind})`])
    .filter(([at]) => data.cases[at].models.some((_, model) => known(at, model).length));
  options(control.case, there, data.start);
  offer();
  if ([...control.quantity.options].some(({ value }) => value === data.quantity)) {
    control.quantity.value = data.quantity;
  }
  await show();
}

{
  const data = document.getElementById("view-data");
  if (data && "DecompressionStream" in window) startView(JSON.parse(data.textContent));
  else if (data) document.getElementById("view-none").hidden = false;
}
