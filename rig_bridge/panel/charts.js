'use strict';
// Charts and tables of the panel, charts of the report. Text from outside goes through textContent only.

const colors = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#000000'];  // Okabe and Ito
const byId = id => document.getElementById(id);
const show = (node, on) => { node.hidden = !on; };
const finite = value => typeof value === 'number' && isFinite(value);
const quoted = text => '"' + text.replaceAll('"', '""') + '"';
const number = value => finite(value) ? String(+value.toPrecision(4)) : '\u2013';
let about = { channels: [], changes: [] };

function make(tag, text, attributes) {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  for (const [key, value] of Object.entries(attributes || {})) node.setAttribute(key, value);
  return node;
}

function say(text, bad) {
  const node = byId('said');
  node.textContent = text;
  node.className = bad ? 'bad' : '';
  show(node, text !== '');
}

function save(name, type, text) {
  const link = make('a', undefined, { download: name });
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// ---- charts: one for each axis, all of one view zoomed and panned together

const titles = { speed: 'Speed', slip: 'Slip', pressure: 'Brake pressure', current: 'Valve current', load: 'Vertical load',
  temperature: 'Temperature' };

// The charts of the panel's channels. `bars`: each value is [least, last, greatest].
function channelCharts(bars) {
  return [...new Set(about.channels.map(c => c.chart))].map(name => {
    const channels = about.channels.filter(c => c.chart === name), unit = channels[0].unit ? ', ' + channels[0].unit : '';
    return { name, channels, bars, title: titles[name] + unit, unit, x: 'time, s' };
  });
}

class Charts {
  // `list`: [{title, unit, x, bars}], what each is called, its unit as its columns end with it, its abscissa.
  constructor(parent, list) {
    this.all = list.map(chart => {
      const box = make('div', undefined, { class: 'chart' });
      const made = { ...chart, box, plot: make('div', undefined, { class: 'plot' }), legend: make('div', undefined, { class: 'legend' }) };
      box.append(make('h3', chart.title), made.plot, made.legend);
      parent.append(box);
      return made;
    });
  }

  // `series` of a chart: [{label, color, dashed, dot, hidden: not in the legend, look: options of dygraphs}], `rows`: [x, ...]; only what has
  // a value is shown.
  draw(chart, series, rows, options) {
    chart.series = series;
    chart.rows = rows;
    show(chart.box, rows.length > 0 && series.length > 0);
    if (chart.box.hidden || typeof Dygraph === 'undefined') return;
    // A series is named by its place: two runs may have the same label.
    const settings = { file: rows, labels: ['s', ...series.map((s, i) => String(i))], colors: series.map(s => s.color), ...options };
    settings.series = Object.fromEntries(series.map((s, i) => [String(i), { strokePattern: s.dashed ? [6, 4] : null, ...s.look }]));
    if (chart.graph) {
      chart.graph.updateOptions(settings);
    } else {
      chart.graph = new Dygraph(chart.plot, rows, {
        ...settings, customBars: chart.bars, legend: 'never', connectSeparatedPoints: true, strokeWidth: 1.6, gridLineColor: '#d0d7de',
        axisLineColor: '#8b949e', axisLabelFontSize: 11, fillAlpha: 0.3, animatedZooms: false,
        highlightCallback: (event, x, points, row, nearest) => this.label(chart, x, points, nearest), unhighlightCallback: () => this.label(chart),
      });
    }
    this.label(chart);
  }

  // Of many curves the legend has the value of the nearest one.
  label(chart, x, points, nearest) {
    const items = chart.series.flatMap((s, i) => {
      const point = points && (!nearest || nearest === String(i)) && points.find(p => p.name === String(i));
      if (s.hidden && !point) return [];
      const line = make('i', '', { class: s.dot ? 'dot' : s.dashed ? 'dashed' : '' });
      line.style.borderColor = s.color;
      const item = make('span', s.label + (point ? ' ' + number(point.yval) : ''));
      item.prepend(line);
      return [item];
    });
    chart.legend.replaceChildren(...items, x === undefined ? '' : make('span', chart.x + ' ' + number(x)));
  }

  synchronize() {
    const graphs = this.all.filter(c => c.graph && !c.box.hidden).map(c => c.graph);
    if (this.together) this.together.detach();
    this.together = graphs.length > 1 ? Dygraph.synchronize(graphs, { zoom: true, selection: true, range: false }) : null;
  }

  range() {
    const chart = this.all.find(c => c.graph && !c.box.hidden);
    return chart ? chart.graph.xAxisRange() : [-Infinity, Infinity];
  }

  visible() {
    const [from, to] = this.range();
    return this.all.filter(c => !c.box.hidden && c.rows && c.rows.length).map(c => ({ ...c, rows: c.rows.filter(r => r[0] >= from && r[0] <= to) }));
  }

  csv() {
    const charts = this.visible();
    const names = charts.flatMap(c => c.series.map(s => quoted(s.label + c.unit)));
    const rows = new Map();
    let at = 0;
    for (const chart of charts) {
      for (const row of chart.rows) {
        if (!rows.has(row[0])) rows.set(row[0], new Array(names.length).fill(''));
        row.slice(1).forEach((value, i) => { rows.get(row[0])[at + i] = finite(value) ? value : ''; });
      }
      at += chart.series.length;
    }
    const lines = [...rows.entries()].sort((a, b) => a[0] - b[0]).map(([x, values]) => [x, ...values].join(','));
    return [quoted('time, s'), ...names].join(',') + '\n' + lines.join('\n') + '\n';
  }

  svg() {
    const width = 860, height = 190, left = 60, right = 20, charts = this.visible();
    const escape = text => text.replace(/[&<>"]/g, c => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);
    const parts = charts.map((chart, at) => {
      const values = chart.rows.flatMap(r => r.slice(1)).filter(finite);
      let [low, high] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
      if (!(high > low)) [low, high] = [low - 1, high + 1];
      const first = chart.rows[0][0], last = chart.rows[chart.rows.length - 1][0];
      const x = v => left + (v - first) / (last - first || 1) * (width - left - right);
      const y = v => at * height + height - 40 - (v - low) / (high - low) * (height - 75);
      const ticks = [0, 1, 2, 3, 4].map(i => {
        const ty = low + (high - low) * i / 4, tx = first + (last - first) * i / 4;
        return `<path d="M${left} ${y(ty)}H${width - right}" stroke="#e3e7eb"/><text x="${left - 6}" y="${y(ty) + 4}" text-anchor="end">` +
          `${number(ty)}</text><text x="${x(tx)}" y="${at * height + height - 24}" text-anchor="middle">${number(tx)}</text>`;
      });
      const lines = chart.series.map((s, i) => {
        const points = chart.rows.filter(r => finite(r[i + 1])).map(r => x(r[0]).toFixed(1) + ',' + y(r[i + 1]).toFixed(1));
        const dashes = s.dashed ? ' stroke-dasharray="6 4"' : '';
        return `<polyline points="${points.join(' ')}" fill="none" stroke="${s.color}" stroke-width="1.4"${dashes}/>`;
      });
      const names = chart.series.map(s => `<tspan fill="${s.color}" dx="10">${s.dashed ? '\u2013 \u2013' : '\u2014'} ${escape(s.label)}</tspan>`);
      return `<g>${ticks.join('')}${lines.join('')}<text x="${left}" y="${at * height + 18}"><tspan font-weight="bold">${escape(chart.title)}` +
        `</tspan>${names.join('')}</text></g>`;
    });
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${charts.length * height + 10}" font-family="sans-serif" ` +
      `font-size="11"><rect width="100%" height="100%" fill="#fff"/>${parts.join('')}` +
      `<text x="${width / 2}" y="${charts.length * height}">time, s</text></svg>\n`;
  }
}

// ---- runs over each other, for recorded maneuvers and for stops that are tried

class Overlay {
  constructor(place, name) {
    const bar = make('p'), grid = make('div', undefined, { class: 'charts' });
    for (const [type, text] of [['svg', 'View as SVG'], ['csv', 'Data of the view as CSV']]) {
      const button = make('button', text, { type: 'button', class: type });
      button.onclick = () => save(name + '.' + type, type === 'svg' ? 'image/svg+xml' : 'text/csv', this.charts[type]());
      bar.append(button, ' ');
    }
    this.bar = bar;
    show(bar, false);
    place.append(bar, grid);
    this.charts = new Charts(grid, channelCharts(false));
  }

  // `runs`: [{name, columns}]; the columns are those of about.channels, and t, s since brake-on.
  draw(runs) {
    show(this.bar, runs.length > 0);
    for (const chart of this.charts.all) {
      const series = [], rows = new Map();
      // One run: a colour for each channel. Several: one for each run.
      const curves = runs.flatMap((run, r) => chart.channels.map((channel, c) => ({ run, channel, color: colors[(runs.length > 1 ? r : c) % 7],
        dashed: runs.length > 1 && channel.dashed }))).filter(s => (s.run.columns[s.channel.key] || []).some(finite));
      curves.forEach((curve, i) => {
        const label = (runs.length > 1 ? curve.run.name + ' ' : '') + curve.channel.label;
        series.push({ label, color: curve.color, dashed: curve.dashed });
        curve.run.columns.t.forEach((t, k) => {
          if (!rows.has(t)) rows.set(t, new Array(curves.length + 1).fill(null, 1));
          const row = rows.get(t);
          row[0] = t;
          row[i + 1] = curve.run.columns[curve.channel.key][k];
        });
      });
      this.charts.draw(chart, series, [...rows.values()].sort((a, b) => a[0] - b[0]), { dateWindow: null, valueRange: null });
    }
    if (typeof Dygraph !== 'undefined' && runs.length) this.charts.synchronize();
  }
}

// Rows that differ are marked; the second column on says by how much.
// Rows of all keys that any of the runs has in these parts.
function compare(table, runs, parts) {
  table.replaceChildren();
  if (!runs.length) return;
  const head = make('tr');
  head.append(make('th', ''), ...runs.map(r => make('th', r.name)));
  table.append(head);
  const rows = parts.flatMap(part => [...new Set(runs.flatMap(r => Object.keys(r[part])))].map(key => [key, runs.map(r => r[part][key])]));
  for (const [label, values] of rows) {
    const differs = values.some(v => v !== values[0]);
    const row = make('tr', undefined, { class: differs ? 'differs' : '' });
    row.append(make('td', label), ...values.map((v, i) => {
      const by = i > 0 && finite(v) && finite(values[0]) ? v - values[0] : 0;
      const change = by ? ` (${by > 0 ? '+' : '\u2212'}${number(Math.abs(by))})` : '';
      return make('td', finite(v) ? number(v) + change : v === null || v === undefined || v === '' ? '\u2013' : String(v));
    }));
    table.append(row);
  }
}
