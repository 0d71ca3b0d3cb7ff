"use strict";
// Draws each plot from the data beside it, lets the legend switch series, and fits the plots to the paper.
const touch = window.matchMedia("(pointer: coarse)").matches;
const plots = [...document.querySelectorAll(".plot")];
// Pixels of a plot below which rows and axes need shorter labels; beside others on a wide page it has short ones.
const narrow = window.matchMedia("(max-width: 760px)").matches ? 480 : 360;

// On a narrow plot, long names of rows and axes take two lines.
function inTwoLines(text) {
  if (text.length < 17 || text.includes("<br>")) return text;
  const spaces = [...text.matchAll(/ /g)].map((found) => found.index);
  if (!spaces.length) return text;
  const middle = spaces.reduce((best, at) => (Math.abs(at - text.length / 2) < Math.abs(best - text.length / 2) ? at : best));
  return `${text.slice(0, middle)}<br>${text.slice(middle + 1)}`;
}

// In a table's rows "constant load: force 17" is "force 17", or "constant load 17" where another row is a force too.
function shortened(name, _, all) {
  const parameter = (one) => one.replace(/^.*: /, "").replace(/\s*\d+$/, "");
  const alone = all.filter((other) => parameter(other) === parameter(name)).length === 1;
  return name.replace(alone ? /^.*: / : /:.*?(?=\s*\d+$)/, "");
}

function narrowed(layout, table) {
  if (table) table.showscale = false;
  for (const note of layout.annotations || []) if (note.text.length > 28) note.font = { ...note.font, size: 11 };
  for (const key of Object.keys(layout).filter((name) => /^[xy]axis/.test(name))) {
    const axis = layout[key];
    if (key[0] === "y" && axis.ticktext) {
      axis.tickfont = { size: 10 };
      axis.ticktext = axis.ticktext.map(table ? shortened : inTwoLines);
    } else if (key[0] === "y" && axis.title.text.length > 28) {
      axis.title.text = inTwoLines(axis.title.text);
    } else if (key[0] === "x" && axis.title.text.length > 24) {
      axis.title.text = inTwoLines(axis.title.text);
      axis.title.standoff += 10;
      layout.margin.b += 16;
    }
    if (key[0] === "x" && (axis.ticktext || []).length > 5) {
      axis.tickvals = axis.tickvals.filter((_, place) => place % 3 === 0);
      axis.ticktext = axis.ticktext.filter((_, place) => place % 3 === 0);
    }
  }
}

// What stands beside a bar gets the room that it needs on a narrow plot, and does not repeat what the axis says.
function barsNarrowed(bars, layout) {
  bars.text = bars.text.map((text) => text.replace(/ behind$|^best$/, ""));
  const { range } = layout.xaxis;
  if (range && bars.text.some((text) => text.length > 8)) layout.xaxis.range = [range[0], 1.35 * range[1]];
}

for (const place of plots) {
  const { data, layout } = JSON.parse(place.querySelector("script").textContent);
  layout.autosize = true;
  if (place.clientWidth < narrow) {
    narrowed(layout, data.find((trace) => trace.type === "heatmap"));
    for (const bars of data.filter((trace) => trace.type === "bar")) barsNarrowed(bars, layout);
  }
  layout.dragmode = touch ? false : "zoom"; // a finger on a plot scrolls the page
  Plotly.newPlot(place, data, layout, {
    responsive: true,
    displayModeBar: false,
  });
}

for (const button of document.querySelectorAll(".legend button")) {
  button.addEventListener("click", () => {
    const hidden = button.classList.toggle("off");
    for (const place of button.closest("figure").querySelectorAll(".plot")) {
      const label = button.dataset.label;
      const traces = place.data.flatMap((trace, index) => (trace.name === label ? [index] : []));
      if (traces.length) Plotly.restyle(place, { visible: !hidden }, traces);
      (place.layout.shapes || []).forEach((shape, index) => {
        if (shape.name === label) Plotly.relayout(place, { [`shapes[${index}].visible`]: !hidden });
      });
    }
  });
}

// Plots over time show the same span.
const timed = plots.filter((place) => JSON.stringify(place.layout.xaxis.title || "").includes("time [s]") ||
  Object.keys(place.layout).some((key) => key.startsWith("xaxis") && (place.layout[key].title || {}).text === "time [s]"));
let following = false;
for (const place of timed) {
  place.on("plotly_relayout", (change) => {
    const low = change["xaxis.range[0]"], all = change["xaxis.autorange"];
    if (following || (low === undefined && !all)) return;
    following = true;
    const update = all ? { "xaxis.autorange": true } : { "xaxis.range": [low, change["xaxis.range[1]"]] };
    Promise.all(timed.filter((one) => one !== place).map((one) => Plotly.relayout(one, update))).then(() => {
      following = false;
    });
  });
}

for (const button of document.querySelectorAll(".save button")) {
  button.addEventListener("click", () => {
    const figure = button.closest("figure");
    [...figure.querySelectorAll(".plot")].forEach((place, index) => {
      const size = { width: place.clientWidth, height: place.clientHeight, scale: button.dataset.as === "png" ? 2 : 1 };
      Plotly.downloadImage(place, { ...size, format: button.dataset.as, filename: `${figure.dataset.name}-${index + 1}` });
    });
  });
}

function fit(printing) {
  document.body.classList.toggle("printing", printing);
  // at once, for the browser lays out the paper as soon as this returns
  for (const place of plots) Plotly.relayout(place, { width: printing ? place.clientWidth : null, autosize: !printing });
}
window.addEventListener("beforeprint", () => {
  document.querySelectorAll("details").forEach((one) => (one.open = true));
  fit(true);
});
window.addEventListener("afterprint", () => fit(false));
