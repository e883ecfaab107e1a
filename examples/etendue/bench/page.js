"use strict";
// Elements, numbers and the data: what the other parts of the page share.

const DATA = JSON.parse(document.getElementById("data").textContent);
const RESULTS = DATA.results;

/** An element with attributes (functions are listeners) and children. Text stays text: nothing from the data is markup. */
function make(name, attributes = {}, ...children) {
  const isSvg = ["svg", "g", "path", "line", "rect", "circle", "text", "title"].includes(name);
  const element = isSvg ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(key, value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/** A number with three digits that count. */
function digits(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -3 || size > 5) return value.toExponential(2);
  return value.toFixed(Math.max(0, 2 - size));
}

/** Seconds for people. */
function seconds(value) {
  return value < 60 ? `${digits(value)} s` : `${digits(value / 60)} min`;
}

/** Colour and dashes of the curve with this number: colours first, then the same ones dashed. */
function look(number) {
  return { colour: `var(--s${number % 8})`, dash: ["none", "7 4", "2 3"][Math.floor(number / 8) % 3] };
}

const tip = document.getElementById("tip");

/** Shows text beside a place in the window. */
function showTip(text, x, y) {
  tip.textContent = text;
  tip.hidden = false;
  const box = tip.getBoundingClientRect();
  tip.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - box.width - 8))}px`;
  tip.style.top = `${Math.max(4, y + 16 + box.height > innerHeight ? y - box.height - 10 : y + 16)}px`;
}

function hideTip() {
  tip.hidden = true;
}

addEventListener("keydown", (event) => {
  if (event.key === "Escape") hideTip();
});
