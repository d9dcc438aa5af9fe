// Every table can be sorted by a column and taken along as csv.

// What a cell is sorted by: its number, that it begins with, else its text.
function sortKey(cell) {
  if (cell.dataset.value !== undefined) return [0, Number(cell.dataset.value.replace("inf", "Infinity"))];
  const text = cellText(cell);
  const plain = text.replaceAll("−", "-").replaceAll("×", " ");
  const found = plain.match(/^[^\p{L}\d-]*(-?\d+(\.\d+)?(e-?\d+)?)/u);
  if (found) return [0, Number(found[1])];
  if (/^-?∞/.test(plain)) return [0, plain.startsWith("-") ? -Infinity : Infinity];
  return [text === "—" || !text ? 2 : 1, text];
}

function before(one, other) {
  if (one[0] !== other[0]) return one[0] - other[0];
  if (one[0] === 0) return one[1] - other[1];
  return String(one[1]).localeCompare(String(other[1]));
}

// Without the mark of its grade, which repeats its colour.
function cellText(cell) {
  const mark = cell.querySelector(".mark")?.textContent ?? "";
  return cell.textContent.slice(mark.length).trim();
}

function quoted(text) {
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const turned = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", turned === 1 ? "ascending" : "descending");
      const rows = [...body.rows].map((row) => [sortKey(row.cells[column]), row]);
      rows.sort(([one], [other]) => turned * before(one, other));
      body.append(...rows.map(([, row]) => row));
    });
  });
  const link = document.createElement("button");
  link.type = "button";
  link.className = "csv";
  link.textContent = "download csv";
  link.addEventListener("click", () => {
    const lines = [table.tHead.rows[0], ...body.rows].map((row) =>
      [...row.cells].map((cell) =>
        quoted(cell.dataset.value ?? cell.dataset.name ?? cellText(cell).replace(/^—$/, ""))).join(","));
    const away = document.createElement("a");
    // Spreadsheets take a file for UTF-8 that begins with this mark.
    away.href = URL.createObjectURL(new Blob(["\ufeff", lines.join("\r\n"), "\r\n"], { type: "text/csv" }));
    away.download = `${table.dataset.name}.csv`;
    away.click();
    URL.revokeObjectURL(away.href);
  });
  table.parentElement.after(link);
}
