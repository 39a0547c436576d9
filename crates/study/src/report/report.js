"use strict";

// Tables: a click on the head of a column, or Enter on it, sorts the rows by it; again, the other way round.

const EMPTY = new Set(["", "-", "\u2013", "\u2014"]);
const WORDS = new Intl.Collator("en", { numeric: true });
// A number at the start of a cell, such as "0.62 (1.86\u00d7)", "\u22120.07 [\u22120.1, 0]", "3.1e-9", "24 of 24"; not "5k".
const NUMBER = /^[+\-\u2212]?(\d+\.?\d*|\.\d+)(e[+\-\u2212]?\d+)?(?=$|[\s,;%\u00d7[(])/i;

function numberOf(text) {
  const found = NUMBER.exec(text);
  return found ? Number(found[0].replaceAll("\u2212", "-")) : null;
}

// Empty cells come last whatever the direction; rows alike stay in their order.
function sortRows(body, column, direction) {
  const rows = Array.from(body.rows, (row) => ({ row, text: row.cells[column].textContent.trim() }));
  const filled = rows.filter((entry) => !EMPTY.has(entry.text));
  const empty = rows.filter((entry) => EMPTY.has(entry.text));
  const areNumbers = filled.every((entry) => numberOf(entry.text) !== null);
  const order = areNumbers
    ? (a, b) => numberOf(a.text) - numberOf(b.text)
    : (a, b) => WORDS.compare(a.text, b.text);
  filled.sort((a, b) => direction * order(a, b));
  body.append(...filled.concat(empty).map((entry) => entry.row));
}

for (const table of document.querySelectorAll("table.sortable")) {
  const heads = Array.from(table.tHead.rows[0].cells);
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    button.addEventListener("click", () => {
      const ascending = head.getAttribute("aria-sort") !== "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", ascending ? "ascending" : "descending");
      sortRows(table.tBodies[0], column, ascending ? 1 : -1);
    });
    head.append(button);
  });
}

// Frames: one slider for the pictures of all arms.

const player = document.getElementById("player");
if (player) {
  // Time that a frame is shown while they play (chosen: a run of 22 frames takes 6 s).
  const MILLISECONDS = 280;
  const slider = player.querySelector("input");
  const told = player.querySelector("output");
  const play = player.querySelector("[data-act=play]");
  const steps = JSON.parse(player.dataset.steps);
  const strips = Array.from(document.querySelectorAll(".strip"), (strip) => ({
    pictures: Array.from(strip.querySelectorAll(".picture")),
    shown: JSON.parse(strip.dataset.shown),
  }));
  let timer = null;

  const show = (step) => {
    slider.value = step;
    slider.setAttribute("aria-valuetext", steps[step]);
    told.textContent = steps[step];
    for (const strip of strips) {
      strip.pictures.forEach((picture, number) => (picture.hidden = number !== strip.shown[step]));
    }
  };
  const stop = () => {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
  };
  const go = (step) => show(Math.min(Math.max(step, 0), steps.length - 1));
  const start = () => {
    if (Number(slider.value) === steps.length - 1) show(0);
    play.textContent = "Pause";
    timer = setInterval(() => {
      go(Number(slider.value) + 1);
      if (Number(slider.value) === steps.length - 1) stop();
    }, MILLISECONDS);
  };
  const act = {
    previous: () => (stop(), go(Number(slider.value) - 1)),
    next: () => (stop(), go(Number(slider.value) + 1)),
    play: () => (timer === null ? start() : stop()),
  };
  slider.addEventListener("input", () => (stop(), show(Number(slider.value))));
  for (const button of player.querySelectorAll("button")) {
    button.addEventListener("click", act[button.dataset.act]);
  }

  // Who asks for little motion steps by hand.
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const calm = () => {
    play.hidden = still.matches;
    if (still.matches) stop();
  };
  still.addEventListener("change", calm);
  calm();
  show(steps.length - 1);
  player.hidden = false;
}
