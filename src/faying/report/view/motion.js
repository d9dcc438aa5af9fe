// How the surface moves over the states of a load case: amplitudes times shapes.

// Displacements (n, 3) in a frame, amplitudes times shapes; null where they are not known.
function displaced({ rows, columns, values, at, amplitudes }, frame) {
  const share = amplitudes[at.indexOf(frame)];
  if (!share) return null;
  const found = new Float32Array(3 * rows);
  for (let node = 0; node < rows; node++) {
    share.forEach((factor, shape) => {
      for (let axis = 0; axis < 3; axis++) {
        found[3 * node + axis] += factor * values[node * columns + 3 * shape + axis];
      }
    });
  }
  return found;
}

// How far a point of the surface is displaced in each frame that is known.
function travel({ columns, values, at, amplitudes }, node) {
  return at.map((frame, row) => [frame, Math.hypot(...[0, 1, 2].map((axis) =>
    amplitudes[row].reduce((sum, factor, shape) =>
      sum + factor * values[node * columns + 3 * shape + axis], 0)))]);
}
