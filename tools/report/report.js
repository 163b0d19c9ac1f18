// Draws the plots and the state strip from the JSON in #data. All plots zoom and point together (synchronizer.js of
// dygraphs); colours come from the style sheet, so that light, dark and paper are decided in one place.
(function () {
  'use strict';
  const data = JSON.parse(document.getElementById('data').textContent);
  const STATES = ['OK', 'uncertain', 'lost'];
  const PRINT_WIDTH = 680;  // px: the text width of a sheet of A4

  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const short = v => String(+v.toPrecision(4));
  const over_time = plot => plot.x === 'time_s';
  const x_value = plot => over_time(plot) ? v => v.toFixed(3) + ' s' : v => v.toFixed(3) + ' Hz';
  const x_label = plot => over_time(plot) ? v => +v.toFixed(6) + ' s' : v => +v.toFixed(6) + ' Hz';

  function rows(plot) {
    const columns = data.tables[plot.table];
    const series = plot.series.map(s => columns[s.column]);
    const lowest = plot.log_from > 0 ? plot.log_from : -Infinity;
    const mean = s => {
      const known = plot.about_mean ? s.filter(v => v !== null) : [];
      return known.reduce((sum, v) => sum + v, 0) / Math.max(known.length, 1);
    };
    const means = series.map(mean);
    const value = (v, less) => v === null ? null : Math.max((v - less) * plot.scale, lowest);
    return columns[plot.x].map((t, i) => [t].concat(series.map((s, k) => value(s[i], means[k]))));
  }

  // Seven colours, then the same ones dashed; truth broad and pale. Series are counted without it.
  function pens(plot) {
    let i = 0;
    return plot.series.map(s => s.truth ? {color: css('--truth'), width: 7, mark: 'truth'} :
        {color: css('--s' + (i % 7)), width: 1.3, mark: i++ % 14 < 7 ? '' : 'dashes'});
  }

  // What a screen reader says about a plot.
  function describe(plot, table) {
    const parts = plot.series.map((s, i) => {
      let sum = 0, n = 0, low = Infinity, high = -Infinity;
      for (const row of table) {
        const v = row[i + 1];
        if (v === null) continue;
        sum += v * v; n += 1; low = Math.min(low, v); high = Math.max(high, v);
      }
      return n === 0 ? s.label + ': no values'
          : `${s.label}: from ${short(low)} to ${short(high)} ${plot.unit}, RMS ${short(Math.sqrt(sum / n))}`;
    });
    return plot.title + '. ' + parts.join('; ') + '.';
  }

  // As many decimals as tell a ten-thousandth of the largest value of the plot.
  function value_format(plot, table) {
    if (plot.log_from > 0) return v => (v <= plot.log_from ? '≤ ' : '') + short(v);
    let largest = 0;
    for (const row of table)
      for (let i = 1; i < row.length; ++i) largest = Math.max(largest, Math.abs(row[i]));
    const decimals = Math.min(Math.max(4 - Math.ceil(Math.log10(largest || 1)), 0), 12);
    return v => (+v.toFixed(decimals) || 0).toFixed(decimals);
  }

  // A logarithmic axis has a line at every power of ten that there is room for.
  function decades(low, high, pixels) {
    const from = Math.ceil(Math.log10(low) - 1e-9), to = Math.floor(Math.log10(high) + 1e-9), ticks = [];
    const every = Math.max(1, Math.ceil((to - from + 1) * 24 / pixels));
    const raised = e => String(e).replace(/-/, '⁻').replace(/\d/g, d => '⁰¹²³⁴⁵⁶⁷⁸⁹'[d]);
    for (let e = to; e >= from; e -= every)
      ticks.push({v: Math.pow(10, e), label: Math.abs(e) < 3 ? String(+Math.pow(10, e).toPrecision(1)) : '10' + raised(e)});
    return ticks;
  }

  // The names of the lines, with their values where the pointer is; the time stands beside the unit.
  function legend(plot, d) {
    const marks = pens(plot);
    d.dygraph.graphDiv.parentNode.previousElementSibling.querySelector('.at').textContent =
        d.x === undefined ? '' : 'at ' + d.xHTML;
    return d.series.map((s, i) => `<span class="key"><i class="${marks[i].mark}" style="color:${s.color}"></i>${s.labelHTML}` +
        `<b>${d.x === undefined ? '' : s.yHTML === undefined ? '–' : s.yHTML}</b></span>`).join('');
  }

  // Spans of frames that are not OK: [from, to, state] in seconds.
  function troubled(row) {
    const t = data.tables[row.table].time_s, s = data.tables[row.table][row.column];
    const spans = [];
    for (let i = 0; i < t.length; ++i) {
      if (!s[i]) continue;
      const last = spans[spans.length - 1], end = i + 1 < t.length ? t[i + 1] : t[i];
      if (last && last[2] === s[i] && last[1] === t[i]) last[1] = end; else spans.push([t[i], end, s[i]]);
    }
    return spans;
  }
  const troubles = data.states.map(troubled);

  function paint(spans, context, g, top, height, colour) {
    const [from, to] = g.xAxisRange(), area = g.getArea();
    for (const [a, b, state] of spans) {
      if (b < from || a > to) continue;
      const x0 = Math.max(g.toDomXCoord(a), area.x), x1 = Math.min(g.toDomXCoord(b), area.x + area.w);
      context.fillStyle = colour(state);
      context.fillRect(x0, top(state), Math.max(x1 - x0, 1.5), height(state));
    }
  }

  // A line in time for each tracker, below the first plot: state by colour and by height, so that neither is needed
  // alone.
  function strip(g, index) {
    const canvas = document.getElementById('strip' + index);
    if (!canvas) return;
    const ratio = window.devicePixelRatio || 1, w = g.size().width, h = 22, area = g.getArea();
    canvas.width = w * ratio; canvas.height = h * ratio;
    canvas.style.width = w + 'px';
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    context.fillStyle = css('--ok');
    context.fillRect(area.x, 15, area.w, 5);
    paint(troubles[index], context, g, s => s === 2 ? 2 : 8, s => s === 2 ? 18 : 12, s => css(s === 2 ? '--lost' : '--uncertain'));
  }

  // dygraphs takes every finger for a pan and so would stop a phone from scrolling the page: only two fingers zoom.
  function interaction() {
    const base = Dygraph.defaultInteractionModel, two = e => e.touches.length > 1;
    return Object.assign({}, base, {
      touchstart(e, g, context) { if (two(e)) base.touchstart(e, g, context); },
      touchmove(e, g, context) { if (two(e)) base.touchmove(e, g, context); }
    });
  }

  function look(plot) {
    const series = {};
    pens(plot).forEach((pen, i) => {
      series[plot.series[i].label] =
          {color: pen.color, strokeWidth: pen.width, strokePattern: pen.mark === 'dashes' ? [6, 3] : null};
    });
    return {
      series, axisLineColor: css('--line'), gridLineColor: css('--line'),
      rangeSelectorPlotStrokeColor: css('--quiet'), rangeSelectorPlotFillColor: css('--line'),
      rangeSelectorPlotFillGradientColor: css('--soft'), rangeSelectorBackgroundStrokeColor: css('--line'),
      rangeSelectorForegroundStrokeColor: css('--quiet'), rangeSelectorVeilColour: css('--veil')
    };
  }

  const graphs = [];
  data.plots.forEach((plot, index) => {
    const place = document.getElementById('plot' + index), table = rows(plot);
    if (!place) return;
    place.setAttribute('aria-label', describe(plot, table));
    if (table.length === 0) { place.textContent = 'No frames.'; place.style.height = 'auto'; return; }
    const first = index === 0;
    const g = new Dygraph(place, table, Object.assign({
      labels: [over_time(plot) ? 'time' : 'frequency'].concat(plot.series.map(s => s.label)), labelsDiv: document.getElementById('legend' + index),
      legend: 'always', legendFormatter: d => legend(plot, d), logscale: plot.log_from > 0, highlightCircleSize: 3, axisLabelFontSize: 12,
      xRangePad: 0, interactionModel: interaction(), showRangeSelector: first, rangeSelectorHeight: 28,
      axes: {
        x: {valueFormatter: x_value(plot), axisLabelFormatter: x_label(plot), pixelsPerLabel: 70},
        y: Object.assign({valueFormatter: value_format(plot, table), axisLabelWidth: 44, pixelsPerLabel: 32},
            plot.log_from > 0 ? {ticker: decades} : {})
      },
      // the troubles of several trackers would lie over each other: the gaps in their lines tell
      underlayCallback: (context, area, me) => troubles.length === 1 && over_time(plot) && paint(troubles[0], context, me, () => area.y,
          () => area.h, s => css(s === 2 ? '--shade-lost' : '--shade-uncertain')),
      drawCallback: me => {
        document.body.classList.toggle('zoomed', me.isZoomed('x'));
        if (first) data.states.forEach((_, i) => strip(me, i));
      }
    }, look(plot)));
    place.addEventListener('keydown', e => keys(e, g));
    graphs.push({g, plot});
  });
  const timed = graphs.filter(p => over_time(p.plot));
  // Plots of the same table are about the same run: they zoom and point together.
  new Set(timed.map(p => p.plot.table)).forEach(table => {
    const together = timed.filter(p => p.plot.table === table).map(p => p.g);
    if (together.length > 1) Dygraph.synchronize(together, {selection: true, zoom: true, range: false});
  });

  function whole() { graphs.forEach(p => p.g.resetZoom()); }
  document.querySelectorAll('button.whole').forEach(b => b.addEventListener('click', whole));

  // Arrows pan, + and - zoom, 0 shows the whole run.
  function keys(e, g) {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const [from, to] = g.xAxisRange(), [low, high] = g.xAxisExtremes(), width = to - from;
    const show = (a, b) => g.updateOptions({dateWindow: [Math.max(a, low), Math.min(b, high)]});
    const move = d => show(Math.min(from + d, high - width), Math.max(to + d, low + width));
    const actions = {
      ArrowLeft: () => move(-width / 5), ArrowRight: () => move(width / 5),
      '+': () => show(from + width / 4, to - width / 4), '=': () => show(from + width / 4, to - width / 4),
      '-': () => show(from - width / 2, to + width / 2), '0': whole, Home: whole
    };
    if (!actions[e.key]) return;
    e.preventDefault();
    actions[e.key]();
  }

  function shares(row, index) {
    const place = document.getElementById('shares' + index);
    if (!place) return;
    const s = data.tables[row.table][row.column], count = [0, 0, 0];
    for (const v of s) count[v === null ? 2 : v] += 1;
    const names = ['--ok', '--uncertain', '--lost'];
    place.innerHTML = STATES.map((name, i) => `<span class="key"><i style="background:var(${names[i]})"></i>${name} ` +
        `${(100 * count[i] / Math.max(s.length, 1)).toFixed(1)} %</span>`).join('');
  }
  data.states.forEach(shares);

  function recolour() { graphs.forEach(p => p.g.updateOptions(look(p.plot))); }
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', recolour);
  // The window does not resize for paper.
  const open = [];
  addEventListener('beforeprint', () => {
    document.documentElement.classList.add('paper');  // the page is still dark at this moment, if it is
    graphs.forEach((p, i) => {
      p.g.updateOptions(look(p.plot), true);
      p.g.resize(PRINT_WIDTH, i === 0 ? 250 : 190);
    });
    document.querySelectorAll('details:not([open])').forEach(d => { d.open = true; open.push(d); });
  });
  addEventListener('afterprint', () => {
    document.documentElement.classList.remove('paper');
    graphs.forEach(p => {
      p.g.graphDiv.parentNode.style.width = p.g.graphDiv.parentNode.style.height = '';
      p.g.resize();
    });
    recolour();
    open.splice(0).forEach(d => { d.open = false; });
  });
  document.documentElement.dataset.plots = graphs.length;
})();
