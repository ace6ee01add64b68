'use strict';
// Strip charts of the last ten seconds and the histogram of latencies. A row is what Picture::row_json (nodes/view/picture.cpp) writes:
// [s, returned x, y, z, size, contact force, depth, energy, force of injected damping].
(function () {
  const SHOWN_S = 10, KEPT_S = 30, GAP_S = 0.05;
  const fixed = (v, digits) => v.toFixed(digits).replace(/^-(0\.?0*)$/, '$1');
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const CHARTS = [
    {name: 'Force returned', unit: 'N', digits: 2, series: [['x', 1, '--x', null], ['y', 2, '--y', [7, 3]], ['z', 3, '--z', [2, 2]]]},
    {name: 'Force magnitude', unit: 'N', digits: 2, series: [['returned', 4, '--returned', null], ['contact', 5, '--contact', [7, 3]]]},
    {name: 'Depth', unit: 'mm', digits: 2, series: [['deepest point or hand', 6, '--depth', null]]},
    {name: 'Energy', unit: 'mJ', digits: 1, series: [['from hand', 7, '--energy', null]],
     second: ['injected damping', 8, '--y', [2, 2], 'N (right)', 2]},
  ];

  function swatch(colorName, pattern) {
    return `<svg viewBox="0 0 18 6" aria-hidden="true"><line x1="0" y1="3" x2="18" y2="3" stroke="${css(colorName)}" stroke-width="2.5"` +
           `${pattern ? ` stroke-dasharray="${pattern.join(' ')}"` : ''}/></svg>`;
  }

  class Chart {
    constructor(parent, what, onZoom) {
      this.what = what, this.columns = what.series.map(s => s[1]);
      this.all = what.series.slice();
      if (what.second) this.all.push(what.second), this.columns.push(what.second[1]);
      const box = parent.appendChild(document.createElement('div'));
      box.className = 'chart';
      this.title = box.appendChild(document.createElement('h2'));
      const plot = box.appendChild(document.createElement('div'));
      plot.className = 'plot';
      this.empty = [[0, ...this.columns.map(() => null)]];
      const series = {};
      for (const [name, , , pattern] of this.all) series[name || what.name] = {strokePattern: pattern};
      if (what.second) series[what.second[0]].axis = 'y2';
      this.graph = new Dygraph(plot.appendChild(document.createElement('div')), this.empty, {
        labels: ['time', ...this.all.map(s => s[0] || what.name)], series, legend: 'never', strokeWidth: 1.6, highlightCircleSize: 3, includeZero: true,
        axes: {x: {axisLabelFormatter: s => `${+s.toFixed(2)} s`, axisLabelWidth: 56, pixelsPerLabel: 70},
               y: {axisLabelWidth: 44, pixelsPerLabel: 24, axisLabelFormatter: v => +v.toPrecision(3)},
               y2: {axisLabelWidth: 34, pixelsPerLabel: 24, axisLabelFormatter: v => +v.toPrecision(3), drawGrid: false, independentTicks: true}},
        rightGap: what.second ? 0 : 38, xRangePad: 0, yRangePad: 4, axisLabelFontSize: 11,
        highlightCallback: (event, x, points) => this.say(points.map(p => p.yval), x), unhighlightCallback: () => this.say(this.newest),
        zoomCallback: (from, to) => onZoom(this, from, to)});
      new ResizeObserver(() => this.graph.resize()).observe(plot);  // the title above it may take another line
      this.recolor();
    }
    recolor() {
      this.title.innerHTML = `<span>${this.what.name} <span class="unit">${this.what.unit}</span></span>` +
        this.all.map(([name, , colorName, pattern, unit]) =>
          `<span class="series">${swatch(colorName, pattern)}${name}<b></b>${unit ? ` <span class="unit">${unit}</span>` : ''}</span>`).join('') +
        '<span class="unit when"></span>';
      this.values = [...this.title.querySelectorAll('b')];
      this.when = this.title.querySelector('.when');
      this.graph.updateOptions({colors: this.all.map(s => css(s[2])), gridLineColor: css('--grid'), axisLineColor: css('--line')});
      this.say(this.newest);
    }
    say(values, when) {
      this.values.forEach((b, n) => {
        const v = values && values[n];
        b.textContent = v === null || v === undefined || Number.isNaN(v) ? '–' : fixed(v, this.all[n][5] || this.what.digits);
      });
      this.when.textContent = when === undefined ? '' : `at ${when.toFixed(3)} s`;
    }
    show(rows, window) {
      const file = rows.length ? rows.map(r => [r[0], ...this.columns.map(c => r[c])]) : this.empty;
      const last = rows[rows.length - 1];
      this.newest = last && this.columns.map(c => last[c]);
      this.graph.updateOptions({file, dateWindow: window});
      if (this.graph.getSelection() < 0) this.say(this.newest);
    }
  }

  class Histogram {
    constructor(parent) {
      const box = parent.appendChild(document.createElement('div'));
      box.className = 'chart histogram';
      this.title = box.appendChild(document.createElement('h2'));
      const plot = box.appendChild(document.createElement('div'));
      plot.className = 'plot';
      this.plot = plot.appendChild(document.createElement('div'));
      this.show(null, {});
    }
    show(latency, counts, isBag, isLockstep) {
      if (!latency || isLockstep) {
        const p50 = counts && counts.latency_p50_us, hasLatency = p50 !== undefined && p50 !== null && !isLockstep;
        this.title.innerHTML = '<span>Latency of the ring <span class="unit">µs</span></span>' +
          (hasLatency ? `<span class="series">by the device: median <b>${p50}</b>, p99 <b>${counts.latency_p99_us}</b></span>` : '');
        this.plot.innerHTML = isLockstep ? '<p class="quiet">Lockstep: latency is not measured.</p>' : '<p class="quiet">No measurement yet.</p>';
        return;
      }
      const from = isBag ? 'Time from a sample to its command, as received by the logger. Too small if the logger is late and receives both together'
                         : "Time from the device's write of a sample to the coupling's write of its command";
      const device = isBag && counts && counts.latency_p50_us ? `<span class="series">by the device: median <b>${counts.latency_p50_us}</b></span>` : '';
      this.title.innerHTML = `<span title="${from}; the last ${latency.samples}">Latency ${isBag ? 'at the logger' : 'of the ring'} <span class="unit">µs</span></span>` +
        `<span class="series">median <b>${latency.p50_us}</b></span><span class="series">p99 <b>${latency.p99_us}</b></span>${device}`;
      const width = this.plot.clientWidth || 400, height = this.plot.clientHeight || 80, left = 44, bottom = 18, right = 38;
      const bins = latency.counts.length, most = Math.max(...latency.counts, 1), w = (width - left - right) / bins, h = height - bottom - 12;
      const percent = 100 * most / latency.samples;
      let svg = `<svg role="img" aria-label="Histogram of latencies" viewBox="0 0 ${width} ${height}">`;
      latency.counts.forEach((n, i) => {
        const y = Math.max(n > 0 ? 1 : 0, n / most * h);
        svg += `<rect x="${(left + i * w + 0.5).toFixed(1)}" y="${(height - bottom - y).toFixed(1)}" width="${(w - 1).toFixed(1)}" height="${y.toFixed(1)}"${i === bins - 1 ? ' class="over"' : ''}/>`;
      });
      svg += `<line x1="${left}" x2="${width - right}" y1="${height - bottom}" y2="${height - bottom}" stroke="${css('--line')}"/>`;
      for (let us = 0; us < latency.bin_us * (bins - 1); us += 200)
        svg += `<text x="${left + us / latency.bin_us * w}" y="${height - 5}" text-anchor="middle">${us}</text>`;
      svg += `<text x="${width - right}" y="${height - 5}" text-anchor="middle">over ${latency.bin_us * (bins - 1)}</text>`;
      svg += `<text x="${left - 5}" y="20" text-anchor="end">${percent.toFixed(0)} %</text><text x="${left - 5}" y="${height - bottom}" text-anchor="end">0</text></svg>`;
      this.plot.innerHTML = svg;
    }
  }

  class Charts {
    constructor(parent, onPause) {
      this.rows = [], this.onPause = onPause;
      this.charts = CHARTS.map(what => new Chart(parent, what, (chart, from, to) => this.zoomed(from, to)));
      this.histogram = new Histogram(parent);
    }
    clear() { this.rows = [], this.window = null; }
    replace(rows) { this.clear(), this.add(rows); }
    add(rows) {
      for (const row of rows) {
        const last = this.rows[this.rows.length - 1];
        if (last && row[0] <= last[0]) {
          if (row[0] > last[0] - 1) continue;  // had it already
          this.rows = [];
        } else if (last && row[0] - last[0] > GAP_S) {
          this.rows.push([last[0] + 0.001, ...row.slice(1).map(() => null)]);  // nothing came: a gap, no line
        }
        this.rows.push(row);
      }
      const newest = this.rows.length ? this.rows[this.rows.length - 1][0] : 0;
      let first = 0;
      while (first < this.rows.length && this.rows[first][0] < newest - KEPT_S) ++first;
      if (first) this.rows.splice(0, first);
    }
    // A stretch that was chosen in one chart is shown in all, and stays until a double click.
    zoomed(from, to) {
      const newest = this.rows.length ? this.rows[this.rows.length - 1][0] : 0, whole = to - from >= Math.min(SHOWN_S, newest) * 0.98;
      this.window = whole ? null : [from, to];
      this.onPause(!whole);
      this.draw();
    }
    draw() {
      const newest = this.rows.length ? this.rows[this.rows.length - 1][0] : SHOWN_S;
      const window = this.window || [Math.max(0, newest - SHOWN_S), Math.max(SHOWN_S, newest)];
      for (const chart of this.charts) chart.show(this.rows, window);
    }
    recolor() { for (const chart of this.charts) chart.recolor(); }
  }
  window.Charts = Charts;
})();
