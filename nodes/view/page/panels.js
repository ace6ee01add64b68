'use strict';
// The table of nodes, the design, and the effects with their switches. All text that comes from the ring is set as text, never as markup.
(function () {
  const $ = id => document.getElementById(id);
  const element = (tag, text, attributes = {}) => {
    const e = document.createElement(tag);
    if (text !== undefined) e.textContent = text;
    for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
    return e;
  };

  function showNodes(nodes) {
    const body = $('node-rows');
    if (!nodes.length) {
      body.replaceChildren(element('tr'));
      body.firstChild.append(element('td', 'No node found.', {colspan: 4}));
      return;
    }
    body.replaceChildren(...nodes.map(n => {
      const row = element('tr', undefined, {'data-node': n.node, 'data-state': n.state});
      const rate = n.rate_hz === null ? '–' : `${n.rate_hz.toFixed(0)} ${n.counted}/s`.replace('samples/s', 'Hz').replace('messages', 'msg').replace('verdicts', 'checks');
      row.append(element('th', n.node, {scope: 'row', title: `process ${n.pid} on ${n.host}`}), element('td', n.state, {class: 'state'}),
                 element('td', rate, {class: 'number'}), element('td', n.sentence, {title: n.sentence}));
      return row;
    }));
  }

  function showCounts(counts, nodes) {
    const device = nodes.find(n => n.node === 'device');
    if (!counts) return void ($('counts').textContent = '');
    const answered = device && device.answered_ratio !== null ? `answered in the last second ${(100 * device.answered_ratio).toFixed(1)} % · ` : '';
    $('counts').textContent = `${answered}guard: ${counts.refused} refused, ${counts.clamped} clamped · ${counts.overruns} overruns · ` +
      `${counts.deadline_misses} missed deadlines` + (counts.latency_max_us ? ` · latency max ${counts.latency_max_us} µs` : '');
  }

  function showDesign(design) {
    const text = design ? `${design.status.replaceAll('_', ' ')} – ${design.sentence}` : 'not designed yet';
    $('design-text').textContent = text;
    $('design').title = design ? [text, ...(design.worst_case ? [`Worst case: ${design.worst_case}`] : []), ...design.reasons].join('\n') : '';
  }

  class Effects {
    constructor(send) {
      this.send = send, this.snapshot = '', this.readOnly = false, this.reported = new Set();
    }

    // Built anew only when something has changed, and not under a hand that is at a slider or typing.
    show(effects, readOnly) {
      const snapshot = JSON.stringify([effects, readOnly]);
      const typed = document.activeElement, typing = typed && typed.matches('.value input') && typed.value !== typed.defaultValue && !this.refused;
      if (snapshot === this.snapshot || this.held || typing) return;
      this.refused = false;
      const open = new Set([...document.querySelectorAll('.effect details[open]')].map(d => d.dataset.effect));
      const focused = document.activeElement && document.activeElement.dataset ? document.activeElement.dataset.key : undefined;
      this.snapshot = snapshot, this.readOnly = readOnly;
      const list = $('effect-list');
      list.replaceChildren(...(effects.length ? effects.map(e => this.row(e, open.has(e.name))) : [element('p', 'This scene has no effects.', {class: 'quiet'})]));
      if (focused) [...list.querySelectorAll('[data-key]')].find(e => e.dataset.key === focused)?.focus();
    }

    row(effect, open) {
      const box = element('div', undefined, {class: 'effect', 'data-effect': effect.name});
      const head = box.appendChild(element('div', undefined, {class: 'head'}));
      const label = head.appendChild(element('label', undefined, {title: effect.says}));
      const toggle = label.appendChild(element('input', undefined, {type: 'checkbox', role: 'switch', 'data-key': effect.name + ' switch'}));
      label.append(effect.name);
      toggle.checked = effect.on, toggle.disabled = this.readOnly || effect.fixed;
      toggle.addEventListener('change', () => this.ask([effect.name, toggle.checked ? 'on' : 'off']));
      if (!effect.fixed) {
        const gain = box.appendChild(element('label', undefined, {class: 'gain'}));
        gain.append(element('span', 'gain'));
        const slider = gain.appendChild(element('input', undefined, {type: 'range', min: 0, max: 1, step: 0.05, 'data-key': effect.name + ' gain', 'aria-label': `gain of ${effect.name}`}));
        const value = gain.appendChild(element('output', effect.gain.toFixed(2)));
        slider.value = effect.gain, slider.disabled = this.readOnly;
        slider.addEventListener('pointerdown', () => { this.held = true; });
        for (const end of ['pointerup', 'pointercancel']) slider.addEventListener(end, () => { this.held = false; });
        slider.addEventListener('input', () => { value.textContent = Number(slider.value).toFixed(2); });
        slider.addEventListener('change', () => { this.held = false, this.ask([effect.name, 'gain', String(slider.value)]); });
      }
      if (effect.parameters.length) {
        const details = box.appendChild(element('details', undefined, {'data-effect': effect.name}));
        details.open = open;
        details.append(element('summary', 'values'));
        for (const p of effect.parameters) details.append(this.parameter(effect, p));
      }
      return box;
    }

    parameter(effect, p) {
      const range = `${p.low ?? 0} to ${p.high ?? 'any'}`;
      const label = element('label', undefined, {class: 'value', title: `${p.meaning} (${range})`});
      label.append(element('span', p.name));
      const input = label.appendChild(element('input', undefined, {type: 'text', inputmode: 'decimal', 'data-key': `${effect.name} ${p.name}`}));
      input.defaultValue = p.value.join(','), input.disabled = this.readOnly;
      input.addEventListener('change', () => this.ask([effect.name, `${p.name}=${input.value.trim()}`]));
      return label;
    }

    ask(words) {
      this.say(`${words.join(' ')} …`, null);
      this.send({change: words});
    }
    // The answer to a request of this page.
    answered(answer) {
      if (answer.ok) return;
      this.say(answer.sentence, false);
      this.snapshot = '', this.refused = true;  // what was refused goes back to what is
    }
    // Answers to all requests, from the rendering.
    answers(answers, first) {
      for (const a of answers) {
        const key = a.request + a.result;
        if (this.reported.has(key)) continue;
        this.reported.add(key);
        if (!first) this.say(a.sentence, a.result === 'refused' ? false : a.result === 'done' ? true : null);
      }
    }
    say(text, ok) {
      const answer = $('answer');
      answer.textContent = (ok === true ? '✓ ' : ok === false ? '✕ ' : '') + text;
      answer.dataset.ok = String(ok);
    }
  }

  window.Panels = {showNodes, showCounts, showDesign, Effects};
})();
