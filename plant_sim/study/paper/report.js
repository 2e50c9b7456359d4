'use strict';
// The report's figures as charts that zoom. On paper, and where there is no script, the picture stands in their place.

// Rows [x, value of each series]. Series have their own x, and some the same x twice: a row for each time it is there.
function rowsOf(chart, bars) {
  const rows = new Map();
  chart.series.forEach((s, i) => {
    let before, times = 0;
    s.x.forEach((x, k) => {
      times = x === before ? times + 1 : 0;
      before = x;
      const key = x + ' ' + times;
      if (!rows.has(key)) rows.set(key, [x, ...new Array(chart.series.length).fill(null)]);
      const y = s.y[k] === null ? NaN : s.y[k];  // null: nothing at this x, the line goes on; NaN: it breaks
      rows.get(key)[i + 1] = bars ? [s.low ? s.low[k] : y, y, s.high ? s.high[k] : y] : y;
    });
  });
  return [...rows.values()].sort((a, b) => a[0] - b[0]);
}

function csvOf(chart, rows, bars) {
  const names = chart.series.flatMap(s => [s.name, ...(s.low ? [s.name + ', low', s.name + ', high'] : [])]);
  const text = value => finite(value) ? value : '';
  const lines = rows.map(row => [row[0], ...chart.series.flatMap((s, i) => {
    const cell = row[i + 1] || [];
    return bars ? [text(cell[1]), ...(s.low ? [text(cell[0]), text(cell[2])] : [])] : [text(row[i + 1])];
  })].join(','));
  return [[chart.x, ...names].map(quoted).join(','), ...lines].join('\n') + '\n';
}

function lookOf(series) {
  const look = { strokeWidth: series.style === 'points' ? 0 : series.width };
  if (series.style === 'points') Object.assign(look, { drawPoints: true, pointSize: series.x.length > 20 ? 1.5 : 4 });
  if (series.notes) {
    const notes = new Map(series.x.map((x, k) => [x, series.notes[k]]));
    look.drawPoints = true;
    look.drawPointCallback = (graph, name, context, x, y, color, size, row) => {
      if (series.style === 'points') Dygraph.Circles.DEFAULT(graph, name, context, x, y, color, size);
      context.fillStyle = '#444';
      context.fillText(notes.get(graph.getValue(row, 0)) || '', x + 5, y - 5);
    };
  }
  return look;
}

function drawFigure(figure) {
  const data = JSON.parse(figure.querySelector('script').textContent);
  const grid = make('div', undefined, { class: data.columns > 1 ? 'charts two' : 'charts' });
  figure.prepend(grid);
  figure.classList.add('live');
  const some = data.charts.map(c => c.series.some(s => s.low));
  const charts = new Charts(grid, data.charts.map((c, i) => ({ title: (c.title ? c.title + ': ' : '') + c.y, x: c.x, bars: some[i] })));
  data.charts.forEach((chart, at) => {
    chart.series.forEach(s => { if (!Array.isArray(s.x)) s.x = chart.series[s.x].x; });
    const rows = rowsOf(chart, some[at]), many = chart.series.length > 10, made = charts.all[at];
    const series = chart.series.map(s => ({ label: s.name, color: s.color, dashed: s.style === 'dashes', dot: s.style === 'points',
      hidden: !s.legend || !s.name, look: lookOf(s) }));
    charts.draw(made, series, rows, {
      dateWindow: chart.x_range, valueRange: chart.y_range, xlabel: chart.x, xLabelHeight: 16, rightGap: chart.series.some(s => s.notes) ? 28 : 5,
      axes: { x: { logscale: chart.log_x }, y: { logscale: chart.log_y } }, xRangePad: chart.x_range ? 0 : 8,
      highlightSeriesOpts: many ? { strokeWidth: 3 } : null,
      underlayCallback: (context, area, graph) => {
        context.fillStyle = '#555';
        for (const x of chart.marks) context.fillRect(graph.toDomXCoord(x), area.y, 1, area.h);
      },
    });
    const button = make('button', 'Data as CSV', { type: 'button', class: 'csv' });
    button.onclick = () => save(figure.id + (data.charts.length > 1 ? '-' + (at + 1) : '') + '.csv', 'text/csv', csvOf(chart, rows, some[at]));
    made.box.append(button);
  });
  if (data.charts.every(c => c.x === data.charts[0].x && String(c.x_range) === String(data.charts[0].x_range))) charts.synchronize();
}

for (const figure of document.querySelectorAll('figure'))
  if (figure.querySelector('script') && typeof Dygraph !== 'undefined') drawFigure(figure);
