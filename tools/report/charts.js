// Draws the charts from the JSON in #charts with Chart.js. Colours come from the style sheet; every series also has a mark
// or a hatch of its own, so that colour is not needed.
(function () {
  'use strict';
  const charts = JSON.parse(document.getElementById('charts').textContent);
  const MARKS = ['circle', 'rect', 'triangle', 'rectRot', 'crossRot', 'star', 'rectRounded', 'cross'];
  const PRINT_WIDTH = 680, PRINT_HEIGHT = 300;  // px: the text width of a sheet of A4

  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const short = v => String(+v.toPrecision(4));
  const pen = i => css('--s' + (i % 7));
  const pale = colour => colour + '38';  // the style sheet has them as #rrggbb

  // What Chart.js does not draw: the interval of a point, or the whiskers and the median of a box.
  const intervals = {
    id: 'intervals',
    afterDatasetsDraw(chart) {
      const c = chart.ctx, y = chart.scales.y;
      chart.data.datasets.forEach((set, i) => {
        if (!set.intervals || !chart.isDatasetVisible(i)) return;
        c.save();
        c.strokeStyle = set.borderColor;
        const line = (x0, y0, x1, y1) => { c.beginPath(); c.moveTo(x0, y0); c.lineTo(x1, y1); c.stroke(); };
        chart.getDatasetMeta(i).data.forEach((bar, k) => {
          const [, middle, low, high, q1, q3] = set.intervals[k];
          if (low === null || high === null) return;
          c.lineWidth = 1.5;
          const half = q1 === null ? 4 : Math.min(bar.width / 4, 8), at = v => y.getPixelForValue(v);
          const ends = q1 === null ? [[low, high]] : [[low, q1], [q3, high]];
          ends.forEach(([a, b]) => line(bar.x, at(a), bar.x, at(b)));
          [low, high].forEach(v => line(bar.x - half, at(v), bar.x + half, at(v)));
          if (q1 === null) return;
          c.lineWidth = 3;
          line(bar.x - bar.width / 2, at(middle), bar.x + bar.width / 2, at(middle));
        });
        c.restore();
      });
    }
  };

  const range = p => p[2] === null ? '' : ` [${short(p[2])}, ${short(p[3])}]`;

  function dataset(chart, s, i) {
    const colour = pen(i), common = {label: s.label, borderColor: colour, intervals: s.points, names: s.names};
    if (chart.kind === 'boxes')
      return Object.assign(common, {
        data: chart.categories.map((_, k) => { const p = s.points[k]; return p && p[4] !== null ? [p[4], p[5]] : null; }),
        backgroundColor: pale(colour), borderWidth: i < 7 ? 1.5 : 3, borderSkipped: false, maxBarThickness: 46,
        minBarLength: 1
      });
    const data = s.points.map(p => ({x: p[0], y: p[1]}));
    if (s.front)
      return Object.assign(common, {
        type: 'line', data, showLine: true, stepped: 'before', borderColor: css('--quiet'), borderDash: [5, 4], borderWidth: 1.5,
        pointStyle: 'line', pointRadius: 0, pointHitRadius: 0, intervals: null
      });
    return Object.assign(common, {
      data, backgroundColor: colour, pointStyle: MARKS[i % MARKS.length], pointRadius: 5, pointHoverRadius: 7, borderWidth: 2,
      borderDash: i < 7 ? [] : [6, 4], showLine: chart.kind === 'lines'
    });
  }

  function scale(title, log, more) {
    const ticks = {color: css('--quiet')};
    if (log) ticks.callback = v => /^[125]/.test(String(v).replace(/^0?\.?0*/, '')) ? short(v) : '';
    return Object.assign({
      type: log ? 'logarithmic' : 'linear', title: {display: title !== '', text: title, color: css('--quiet')}, ticks,
      grid: {color: css('--line'), borderColor: css('--line')}
    }, more);
  }

  // Room for every interval, also for its ends; and for the first and the last mark.
  function room(chart) {
    const all = chart.series.flatMap(s => s.points.flatMap(p => p.slice(1))).filter(v => v !== null);
    const low = Math.min(...all), high = Math.max(...all), more = 0.05 * (high - low);
    return chart.log_y ? {suggestedMin: low / 1.15, suggestedMax: high * 1.15}
        : {suggestedMin: chart.kind === 'boxes' ? low - more : Math.min(0, low - more), suggestedMax: high + more};
  }

  function options(chart) {
    const boxes = chart.kind === 'boxes';
    return {
      animation: false, responsive: true, maintainAspectRatio: false,
      // a finger that scrolls the page is not a finger that points
      interaction: {mode: boxes ? 'point' : 'nearest', intersect: true},
      scales: {
        x: scale(chart.x, chart.log_x, boxes ? {type: 'category'} : {grace: '4%'}),
        y: scale(chart.y, chart.log_y, room(chart))
      },
      plugins: {
        legend: {
          display: chart.series.length > 1,
          labels: {color: css('--ink'), usePointStyle: !boxes, boxWidth: boxes ? 24 : 10}
        },
        tooltip: {
          callbacks: {
            title: items => items.length ? items[0].dataset.names[items[0].dataIndex] || items[0].label : '',
            label: item => {
              const p = item.dataset.intervals && item.dataset.intervals[item.dataIndex];
              return p ? `${item.dataset.label}: ${short(p[1])}${range(p)}` : item.dataset.label;
            }
          },
          filter: item => Boolean(item.dataset.intervals)
        }
      }
    };
  }

  // What a screen reader says about a chart.
  function describe(chart) {
    const name = (s, k) => chart.kind === 'boxes' ? chart.categories[k] : s.names[k] || short(s.points[k][0]);
    return chart.title + '. ' + chart.series.filter(s => !s.front).map(s => s.label + ': ' + s.points.map((p, k) =>
        p[1] === null ? '' : `${name(s, k)} ${short(p[1])}${range(p)}`).filter(Boolean).join(', ')).join('; ') + '.';
  }

  const drawn = charts.map((chart, index) => {
    const canvas = document.getElementById('chart' + index);
    canvas.setAttribute('aria-label', describe(chart));
    const g = new Chart(canvas, {
      type: chart.kind === 'boxes' ? 'bar' : 'scatter',
      data: {labels: chart.categories, datasets: chart.series.map((s, i) => dataset(chart, s, i))},
      options: options(chart), plugins: [intervals]
    });
    return {g, chart};
  });

  function recolour() {
    drawn.forEach(({g, chart}) => {
      const hidden = chart.series.map((_, i) => !g.isDatasetVisible(i));
      g.data.datasets = chart.series.map((s, i) => Object.assign(dataset(chart, s, i), {hidden: hidden[i]}));
      g.options = options(chart);
      g.update('none');
    });
  }
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', recolour);
  // The window does not resize for paper; report.js has set its colours before.
  addEventListener('beforeprint', () => { recolour(); drawn.forEach(({g}) => g.resize(PRINT_WIDTH, PRINT_HEIGHT)); });
  addEventListener('afterprint', () => { recolour(); drawn.forEach(({g}) => g.resize()); });
  document.documentElement.dataset.charts = drawn.length;
})();
