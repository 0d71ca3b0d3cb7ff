"use strict";
// The page's part of `eha open`: it shows what the server knows, and sends what a person says. Texts from files are
// only ever set as text, never as markup.
const at = (id) => document.getElementById(id);
let choices, file, without, nominal;
let rows = [];          // what the columns are, as page/rows.py has it
let seen = 0;           // bytes of the log of progress that were read
let watching = false;

function made(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name in element) element[name] = value; else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

async function ask(address, options = {}) {
  const answer = await fetch(address, options);
  const body = await answer.json().catch(() => ({error: `the server answered ${answer.status}`}));
  if (!answer.ok) throw new Error(body.error || `the server answered ${answer.status}`);
  return body;
}

const send = (address, content) => ask(address, {method: "POST", body: JSON.stringify(content)});

// ---- the file

async function take(dropped) {
  at("file-error").textContent = "";
  at("drop-text").textContent = `reading ${dropped.name} ...`;
  try {
    show(await ask(`file?name=${encodeURIComponent(dropped.name)}`, {method: "POST", body: dropped}));
  } catch (error) {
    at("file-error").textContent = error.message === "Failed to fetch" ? "the server has ended" : error.message;
  }
  at("drop-text").textContent = "Drop another recording, or a topics or nominal file for this one.";
  at("file").value = "";
}

function show(state) {
  ({choices, file, without, nominal} = state);
  for (const id of ["column-step", "rig-step", "run-step"]) at(id).hidden = !file;
  showSheet();
  showNominal();
  if (!file) return;
  rows = file.rows;
  at("file-name").textContent = `${file.name}: ${file.kind}`;
  at("notes").replaceChildren(...file.notes.map((note) => made("li", {}, note)));
  at("drop-text").textContent = "Drop another recording, or a topics or nominal file for this one.";
  at("account").hidden = at("progress").hidden = at("result-step").hidden = true;
  at("warnings").replaceChildren();
  showColumns();
  if (state.run) { seen = 0; watch(); }
}

// ---- the columns

function showColumns() {
  at("questions").replaceChildren(...file.questions.map(question));
  const places = file.columns.map((_, k) => k);
  if (rows.some((row) => row.column < 0)) places.unshift(-1);
  at("columns").replaceChildren(...places.map(columnRow));
  const missing = openPoints();
  at("open-points").textContent = missing;
  at("start").disabled = Boolean(missing);
}

function openPoints() {
  for (const {channel} of file.questions) if (!answered(channel)) return `Still open: what is ${channel}?`;
  for (const row of rows) {
    if (row.points.some(([, value]) => value === null)) return `Still open: fill in what the numbers of ${row.channel} mean.`;
    if (row.counts && !row.rate) return "Still open: how many rows are there in a second?";
  }
  return rows.some((row) => row.channel !== "time") ? "" : "Say what at least one column is.";
}

const answered = (channel) => without.includes(channel) || rows.some((row) => row.channel === channel);

function question(asked) {
  const {channel, text, answers} = asked;
  const select = made("select", {"aria-label": `answer for ${channel}`});
  if (!answered(channel)) select.append(made("option", {value: "", selected: true}, "choose ..."));
  answers.forEach((answer, k) => {
    const isNow = answer === null ? without.includes(channel) : rows.some((row) =>
      row.channel === channel && row.column === answer.row.column && row.unit === answer.row.unit
      && row.reference === answer.row.reference && row.minus === answer.row.minus && row.day_first === answer.row.day_first);
    const taken = answer !== null && rows.some((row) => row.column === answer.row.column && row.channel !== channel);
    const likely = k === 0 && answer !== null ? " (likely)" : "";
    const words = answer === null ? "there is none" : `${answer.text}${likely}`;
    select.append(made("option", {value: k, selected: isNow, disabled: taken}, words));
  });
  if (answered(channel) && ![...select.options].some((option) => option.defaultSelected || option.selected))
    select.prepend(made("option", {value: "", selected: true}, "as said below"));
  select.onchange = () => {
    const answer = answers[select.value];
    rows = rows.filter((row) => row.channel !== channel);
    without = without.filter((name) => name !== channel);
    if (answer === null) without.push(channel);
    else if (answer) rows.push(structuredClone(answer.row));
    showColumns();
  };
  return made("div", {className: answered(channel) ? "question answered" : "question"},
    made("p", {}, made("b", {}, channel), `: ${text}`), select);
}

function columnRow(place) {
  const column = place < 0 ? {name: "rows of the file", count: null, unit: "", usable: true, outline: []}
    : file.columns[place];
  const row = rows.find((one) => one.column === place);
  const asked = row && (row.points.some(([, value]) => value === null) || (row.counts && !row.rate));
  const tr = made("tr", {className: !column.usable ? "unusable" : asked ? "asked" : row ? "used" : ""});
  const about = [column.count === null ? "" : `${column.count} values`, column.unit && `[${column.unit}]`,
    row && row.assumed ? `assumed: ${row.assumed}` : ""].filter(Boolean).join(", ");
  tr.append(made("td", {className: "name"}, column.name, made("small", {}, about)),
    made("td", {}, outline(column)), made("td", {}, column.usable ? channelOf(place, row) : "not usable"),
    made("td", {}, row ? unitOf(row) : ""), made("td", {className: "more"}, ...(row ? more(row) : [])));
  return tr;
}

function outline(column) {
  const pairs = column.outline, box = document.createElement("div");
  if (!pairs.length || column.low === null) return box;
  const name = "http://www.w3.org/2000/svg", height = 36;
  const svg = document.createElementNS(name, "svg"), path = document.createElementNS(name, "path");
  const span = column.high - column.low || 1;
  const y = (value) => (2 + height * (1 - (value - column.low) / span)).toFixed(1);
  let drawn = "", up = false;
  pairs.forEach(([low, high], k) => {
    if (low === null) { up = false; return; }
    drawn += `${up ? "L" : "M"}${k} ${y(low)}L${k} ${y(high)}`;
    up = true;
  });
  path.setAttribute("d", drawn);
  svg.setAttribute("class", "outline");
  svg.setAttribute("viewBox", `0 0 ${Math.max(1, pairs.length - 1)} ${height + 4}`);
  svg.setAttribute("preserveAspectRatio", "none");
  svg.append(path);
  const digits = (value) => Number(value.toPrecision(4)).toString();
  box.append(svg, made("small", {className: "range"}, `${digits(column.low)} to ${digits(column.high)}`));
  return box;
}

function selectOf(label, options, now, change) {
  const select = made("select", {"aria-label": label});
  for (const [value, text] of options) select.append(made("option", {value, selected: value === now}, text));
  select.onchange = () => { change(select.value); showColumns(); };
  return select;
}

function channelOf(place, row) {
  const options = [["", "-"], ...choices.channels.map((kind) => [kind.name, kind.name.replaceAll("_", " ")])];
  const label = `channel of ${place < 0 ? "the rows" : file.columns[place].name}`;
  return selectOf(label, options, row ? row.channel : "", (channel) => {
    rows = rows.filter((one) => one.column !== place && one.channel !== channel);
    without = without.filter((name) => name !== channel);
    if (!channel) return;
    const kind = kindOf(channel), stated = place < 0 ? "" : file.columns[place].unit;
    rows.push({column: place, channel, unit: kind.units.includes(stated) ? stated : "", turned: false, points: [],
      reference: kind.is_pressure ? "gauge" : "", minus: null, rate: null, day_first: null, assumed: "", counts: place < 0});
  });
}

const kindOf = (channel) => choices.channels.find((kind) => kind.name === channel);

function unitOf(row) {
  const kind = kindOf(row.channel);
  const options = [["", `${kind.si}, or as stated`], ...kind.units.map((unit) => [unit, unit])];
  if (row.channel === "time") options.push(["rows", "counts rows"]);
  return selectOf(`unit of ${row.channel}`, options, row.counts ? "rows" : row.unit, (unit) => {
    row.counts = unit === "rows";
    row.assumed = "";
    row.unit = row.counts ? "" : unit;
    row.rate = row.counts ? row.rate : null;
  });
}

function more(row) {
  if (row.channel === "time") return row.counts ? [numbered("rows in a second", "rows in a second", row.rate, (value) => { row.rate = value; })] : [];
  const parts = [];
  if (kindOf(row.channel).is_pressure) {
    parts.push(selectOf(`reference of ${row.channel}`, [["gauge", "gauge"], ["absolute", "absolute"]],
      row.reference || "absolute", (value) => { row.reference = value; row.assumed = ""; }));
  } else {
    parts.push(ticked("turned", row, row.turned, (value) => { row.turned = value; }));
  }
  parts.push(ticked("two points", row, row.points.length > 0, (value) => { row.points = value ? [[0, 0], [1, null]] : []; }));
  row.points.forEach((pair, k) => parts.push(made("span", {className: "pair"},
    numbered(k ? "and" : "", `${row.channel} recorded ${k + 1}`, pair[0], (value) => { pair[0] = value ?? 0; }),
    numbered("is", `${row.channel} means ${k + 1}`, pair[1], (value) => { pair[1] = value; }),
    row.unit || kindOf(row.channel).si)));
  if (row.minus !== null) parts.push(made("small", {}, `less "${file.columns[row.minus].name}"`));
  return parts;
}

function ticked(text, row, now, change) {
  const box = made("input", {type: "checkbox", checked: now, "aria-label": `${text} of ${row.channel}`});
  box.onchange = () => { change(box.checked); showColumns(); };
  return made("label", {}, box, ` ${text}`);
}

function numbered(text, label, now, change) {
  const input = made("input", {type: "number", step: "any", className: "number", value: now ?? "", "aria-label": label});
  input.onchange = () => {
    change(input.value === "" ? null : Number(input.value));
    showColumns();
  };
  return made("label", {}, `${text} `, input);
}

// ---- the rig

function showSheet() {
  if (at("source").options.length) return;
  for (const {name, summary} of choices.sources)
    at("source").append(made("option", {value: name, selected: name === "servo_valve"}, `${name.replaceAll("_", " ")}: ${summary}`));
  at("source").onchange = showLines;
  showLines();
}

function showLines() {
  const typed = Object.fromEntries([...at("lines").querySelectorAll("input")].map((one) => [one.name, one.value]));
  const source = choices.sources.find(({name}) => name === at("source").value);
  at("lines").replaceChildren(...source.data.map((name) => made("label", {className: "line"},
    made("span", {}, choices.data[name].meaning),
    made("input", {type: "text", name, placeholder: `e.g. ${choices.data[name].example}`, value: typed[name] || ""}))));
}

function showNominal() {
  const known = at("nominal-known");
  known.textContent = nominal ? `Nominal file: ${nominal.name} ` : "Without a nominal file the values that the recording"
    + " carries are taken, or else a cylinder of the catalogue is assumed.";
  if (!nominal) return;
  const forget = made("button", {type: "button", className: "small"}, "go on without it");
  forget.onclick = async () => { await send("nominal", {forget: true}); nominal = null; showNominal(); };
  known.append(made("small", {className: "quiet"}, nominal.note || ""), " ", forget);
}

async function takeSheet() {
  at("sheet-error").textContent = "";
  at("lines").querySelectorAll("small").forEach((one) => one.remove());
  const inputs = [...at("lines").querySelectorAll("input")];
  const lines = Object.fromEntries(inputs.map((one) => [one.name, one.value]));
  try {
    const sheet = await send("nominal", {source: at("source").value, lines});
    for (const [name, problem] of Object.entries(sheet.problems || {}))
      inputs.find((one) => one.name === name).after(made("small", {}, problem));
    if (sheet.problems) return;
    nominal = {name: "as filled in", text: sheet.text, note: `(${sheet.unknown} values unknown)`};
    at("sheet").open = false;
    showNominal();
  } catch (error) {
    at("sheet-error").textContent = error.message;
  }
}

// ---- the diagnosis

async function start() {
  at("start").disabled = true;
  try {
    await send("topics", {rows, without});
    await send("diagnosis", {});
    seen = 0;
    at("warnings").replaceChildren();
    at("account").hidden = at("result-step").hidden = true;
    await watch();
  } catch (error) {
    at("open-points").textContent = error.message;
  }
  at("start").disabled = false;
}

async function watch() {
  if (watching) return;
  watching = true;
  try {
    for (;;) {
      const run = await ask(`diagnosis?from=${seen}`);
      seen = run.next;
      showProgress(run);
      if (!run.running) { showResult(run); break; }
      await new Promise((done) => setTimeout(done, 400));
    }
  } catch (error) {
    at("open-points").textContent = `the server does not answer: ${error.message}`;
  }
  at("stop").hidden = true;
  watching = false;
}

function showProgress(run) {
  at("progress").hidden = !run.running;
  at("stop").hidden = !run.running;
  const last = run.progress.at(-1);
  at("warnings").replaceChildren(...run.warnings.map((warning) => made("li", {}, warning)));
  if (!last) return;
  at("bar").value = last.done / last.of;
  at("phase").textContent = last.phase;
  at("passed").textContent = `${last.seconds.toFixed(0)} s${last.left ? `; left: ${last.left}` : ""}`;
  at("message").textContent = last.message;
}

function showResult(run) {
  if (run.stopped) { at("open-points").textContent = "Stopped."; return; }
  at("account").hidden = !run.account;
  at("account").textContent = run.account;
  if (run.status !== 0 && run.status !== 3) {
    at("open-points").textContent = run.warnings.at(-1) || `the diagnosis ended with status ${run.status}`;
    at("warnings").replaceChildren();
    return;
  }
  at("result-step").hidden = false;
  at("downloads").replaceChildren(...run.files.flatMap((name) =>
    [made("a", {href: `download/${name}`, download: name}, name), " "]));
  const report = at("report");
  report.hidden = !run.files.includes("report.html");
  if (!report.hidden) report.src = `report?${Date.now()}`;
}

// ---- begin

at("file").onchange = () => { if (at("file").files.length) take(at("file").files[0]); };
for (const name of ["dragover", "drop", "dragleave"]) {
  document.addEventListener(name, (event) => {
    event.preventDefault();
    at("drop").classList.toggle("over", name === "dragover");
    if (name === "drop" && event.dataTransfer.files.length) take(event.dataTransfer.files[0]);
  });
}
at("take-sheet").onclick = takeSheet;
at("start").onclick = start;
at("stop").onclick = () => ask("diagnosis", {method: "DELETE"});
ask("state").then(show).catch((error) => { at("file-error").textContent = error.message; });
