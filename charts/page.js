"use strict";
// Values of the run that is nearest to the pointer; a method's curves alone while its name in the legend is under it; a table of
// all runs when it is asked for.
(() => {
  const tip = document.getElementById("tip");
  const reach = 20;  // pixels, from the pointer to a mark
  const said = value => value === null ? "-" : String(Number(value.toPrecision(3)));

  const columns = (data, row) => {
    const [method, setting, error, cost, evaluations, energy, constraint, penetration, status] = row;
    return [
      [data.methods[method][1], said(setting)], ["status", status], ["error", said(error)],
      ["CPU ms a simulated s", said(cost === null ? null : 1e3 * cost)], ["evaluations", said(evaluations)],
      ["energy drift", said(energy)], ["constraint drift, m", said(constraint)], ["penetration, m", said(penetration)]];
  };

  const describe = (data, row) => {
    const lines = columns(data, row).filter(([name, value]) => value !== "-" && !(name === "status" && value === "ok"));
    return [data.methods[row[0]][0], ...lines.map(([name, value]) => name + ": " + value)].join("\n");
  };

  const nearest = (svg, event) => {
    const box = svg.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    let best = null, least = reach;
    for (const mark of svg.querySelectorAll("use[data-r]")) {
      const place = mark.transform.baseVal.getItem(0).matrix, distance = Math.hypot(place.e - x, place.f - y);
      if (distance <= least) best = mark, least = distance;
    }
    return best;
  };

  const showAt = (text, event) => {
    tip.textContent = text;
    tip.style.display = "block";
    const right = event.clientX + 16 + tip.offsetWidth > innerWidth;
    tip.style.left = (right ? event.clientX - 12 - tip.offsetWidth : event.clientX + 16) + "px";
    tip.style.top = Math.min(event.clientY + 12, innerHeight - tip.offsetHeight - 8) + "px";
  };

  const light = (section, method) => {
    section.classList.toggle("lit", method !== null);
    for (const curve of section.querySelectorAll(".curve")) curve.classList.toggle("on", curve.dataset.m === method);
  };

  const fill = (table, data) => {
    if (table.rows.length > 0) return;
    const addLine = (tag, cells) => {
      const line = table.insertRow();
      for (const cell of cells) line.appendChild(document.createElement(tag)).textContent = cell;
    };
    addLine("th", ["method", "setting", ...columns(data, data.rows[0]).slice(1).map(column => column[0])]);
    for (const row of data.rows) addLine("td", [data.methods[row[0]][0], ...columns(data, row).map(column => column[1])]);
  };

  for (const section of document.querySelectorAll("section.scene")) {
    const data = JSON.parse(section.querySelector("script").textContent);
    for (const svg of section.querySelectorAll("svg.chart")) {
      svg.addEventListener("pointermove", event => {
        const mark = nearest(svg, event);
        if (mark === null) tip.style.display = "none";
        else showAt(describe(data, data.rows[mark.dataset.r]), event);
      });
      svg.addEventListener("pointerleave", () => tip.style.display = "none");
    }
    for (const name of section.querySelectorAll(".legend span")) {
      name.addEventListener("pointerenter", () => light(section, name.dataset.m));
      name.addEventListener("pointerleave", () => light(section, null));
    }
    const details = section.querySelector("details");
    details.addEventListener("toggle", () => fill(details.querySelector("table"), data));
  }
})();
