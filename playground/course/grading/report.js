// report.js -- sort and filter the students of a report of grades. Without it all are there, by name.
"use strict";

(() => {
  const list = document.querySelector(".students");
  const tools = document.querySelector(".tools");
  const rows = [...list.children];
  const [sort, show, find] = ["sort", "show", "find"].map((id) => document.getElementById(id));
  const shown = document.getElementById("shown");
  const plain = (text) => text.normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase();
  const names = new Map(rows.map((row) => [row, plain(row.dataset.name)]));
  const points = (row) => Number(row.dataset.points);
  const place = new Map(rows.map((row, index) => [row, index]));
  const orders = { name: () => 0, fewest: (a, b) => points(a) - points(b), most: (a, b) => points(b) - points(a) };

  const update = () => {
    const text = plain(find.value.trim());
    const order = orders[sort.value];
    rows.sort((a, b) => order(a, b) || place.get(a) - place.get(b));
    list.append(...rows);
    let count = 0;
    for (const row of rows) {
      const states = row.dataset.states.split(" ");
      row.hidden = !(show.value === "all" || states.includes(show.value)) || !names.get(row).includes(text);
      count += row.hidden ? 0 : 1;
    }
    shown.textContent = shown.dataset.text.replace("{n}", count).replace("{m}", rows.length);
  };
  for (const tool of [sort, show, find]) tool.addEventListener("input", update);
  tools.hidden = false;
  update();
})();
