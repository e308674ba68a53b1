// Tables are sorted by a click on, or Enter in, the head of a column: by the numbers of cells, else as text.
"use strict";

const numberOf = (cell) => Number(cell.dataset.value); // NaN where there is none

function compareCells(one, other) {
  const [a, b] = [numberOf(one), numberOf(other)];
  if (!Number.isNaN(a) && !Number.isNaN(b)) return a - b;
  return one.textContent.localeCompare(other.textContent, "en", { numeric: true });
}

function sortBy(table, column, direction) {
  const body = table.tBodies[0];
  const isEmpty = (cell) => ["–", ""].includes(cell.textContent.trim());
  const rows = [...body.rows].sort((one, other) => {
    const [a, b] = [one.cells[column], other.cells[column]];
    if (isEmpty(a) || isEmpty(b)) return isEmpty(a) - isEmpty(b); // last in both directions
    return direction * compareCells(a, b);
  });
  body.append(...rows);
}

for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const direction = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", direction === 1 ? "ascending" : "descending");
      sortBy(table, column, direction);
    });
  });
}
