'use strict';
// One page with three views: live, recorded, what if.

async function ask(name, parameters, change) {
  const query = new URLSearchParams(parameters || {});
  const response = change
    ? await fetch('/api/' + name, { method: 'POST', body: query, headers: { 'X-Panel-Token': byId('token').value } })
    : await fetch('/api/' + name + '?' + query);
  const answer = await response.json();
  if (!response.ok) throw Object.assign(new Error(answer.error), { status: response.status });
  return answer;
}

// ---- live

function live() {
  const charts = new Charts(byId('live_charts'), channelCharts(true)), kept_s = 10;
  const boxes = about.channels.map(c => {
    const box = make('div', c.label), value = make('b', '\u2013', { id: 'live_' + c.key });
    box.prepend(value);
    byId('numbers').append(box);
    return { value, unit: c.unit ? ' ' + c.unit : '' };
  });
  let pixels = [], due = false, known = new Set(), sound = null;

  const draw = () => {
    due = false;
    if (!pixels.length || byId('live').hidden) return;
    const now = pixels[pixels.length - 1].t;
    boxes.forEach((box, i) => {
      const value = pixels[pixels.length - 1].v[i][2];
      box.value.textContent = number(finite(value) ? +value.toFixed(3) : value) + box.unit;  // a tile holds no more digits
    });
    for (const chart of charts.all) {
      const shown = chart.channels.map(c => about.channels.indexOf(c)).filter(i => pixels.some(p => p.v[i][2] !== null));
      const rows = pixels.map(p => [p.t, ...shown.map(i => [p.v[i][0], p.v[i][2], p.v[i][1]])]);
      charts.draw(chart, shown.map((i, k) => ({ label: about.channels[i].label, color: colors[k] })), rows, { dateWindow: [now - kept_s, now] });
    }
  };
  const beep = () => {
    if (!sound) return;
    const tone = sound.createOscillator(), loud = sound.createGain();
    tone.frequency.value = 880;
    loud.gain.value = 0.2;
    tone.connect(loud).connect(sound.destination);
    tone.start();
    tone.stop(sound.currentTime + 0.35);
  };
  byId('sound').onclick = () => {
    sound = sound || new AudioContext();
    byId('sound').textContent = 'The alarm\u2019s sound is on';
    beep();
  };

  const source = new EventSource('/events');
  const link = (text, bad) => { byId('link').textContent = text; byId('link').className = bad ? 'mark bad' : 'mark'; };
  source.onopen = () => link('live', false);
  source.onerror = () => link('no connection: what is shown is old', true);
  source.addEventListener('pixel', event => {
    const pixel = JSON.parse(event.data);
    if (pixels.length && pixel.t <= pixels[pixels.length - 1].t) pixels = [];
    pixels.push(pixel);
    while (pixels[0].t < pixel.t - kept_s) pixels.shift();
    if (!due) requestAnimationFrame(draw);
    due = true;
  });
  source.addEventListener('state', event => {
    const state = JSON.parse(event.data);
    byId('facts').replaceChildren(...Object.entries(state.facts).flatMap(([label, value]) => [make('dt', label), make('dd', value)]));
    byId('interlocks').replaceChildren(...Object.entries(state.interlocks).map(([name, good]) =>
      make('li', name + (good ? '' : ': open'), { class: good ? 'good' : 'open' })));
    byId('alarms').replaceChildren(...state.alarms.map(alarm => {
      const box = make('div', undefined, { class: 'alarm' });
      box.append(make('strong', alarm.name), make('span', alarm.happened), make('span', alarm.next ? 'Next: ' + alarm.next : ''));
      return box;
    }));
    offer(state.campaign);
    if (state.alarms.some(a => !known.has(a.name))) beep();
    known = new Set(state.alarms.map(a => a.name));
    document.title = (state.alarms.length ? '\u26a0 ' : '') + about.title;
  });

  const buttons = {};
  // Until the first state all are there: in lockstep none comes while the campaign is held.
  const offer = campaign => {
    if (buttons.hold) show(buttons.hold, campaign === 'runs');
    if (!buttons.resume) return;
    show(buttons.resume, campaign !== 'runs');
    buttons.resume.textContent = campaign === 'waits' ? 'Start' : words.resume;
  };
  const words = { hold: 'Pause after this maneuver', resume: 'Go on', abort: 'Abort this maneuver' };
  for (const name of about.changes.filter(c => words[c])) {
    show(byId('changes'), true);
    const button = make('button', words[name], { type: 'button', id: name, class: name === 'abort' ? 'danger' : '' });
    button.onclick = () => ask(name, { why: byId('why').value }, true).then(a => say(a.said), e => say(e.message, true));
    buttons[name] = button;
    byId('buttons').append(button, ' ');
  }
}

// ---- recorded

async function recorded() {
  const overlay = new Overlay(byId('recorded_charts'), 'maneuvers'), loaded = new Map(), chosen = [];
  let list = [];
  const id = run => [run.campaign, run.number, run.attempt].join('/');
  const place = run => ({ campaign: run.campaign, number: run.number, attempt: run.attempt });

  const draw = () => {
    const runs = chosen.map(key => ({ ...list.find(r => id(r) === key), ...loaded.get(key) })).filter(r => r.columns);
    const of = run => list.some(r => r.campaign !== run.campaign) ? run.campaign + ' ' : '';
    runs.forEach(run => { run.name = `${of(run)}${run.number}${run.attempt > 1 ? '.' + run.attempt : ''}`; });
    overlay.draw(runs);
    compare(byId('differences'), runs, ['configuration', 'asked', 'figures']);
    const last = runs[runs.length - 1];
    show(byId('note'), Boolean(last) && about.changes.includes('note'));
    byId('note_of').textContent = last ? 'maneuver ' + last.name : '';
    byId('notes').replaceChildren(...(last ? last.notes : []).map(n =>
      make('li', `${n.made} ${n.who}: ${n.field === 'notes' ? '' : n.field + ' '}${n.text}`)));
  };
  const choose = async (run, on) => {
    const key = id(run);
    if (on) chosen.push(key); else chosen.splice(chosen.indexOf(key), 1);
    try {
      if (on && !loaded.has(key)) loaded.set(key, await ask('run', place(run)));
      say('');
    } catch (error) {
      say(error.message, true);
    }
    draw();
  };
  const refresh = async () => {
    list = (await ask('runs')).runs;
    const head = make('tr');
    head.append(...['', 'maneuver', 'state', 'began', 'scenario', 'notes'].map(t => make('th', t)));
    byId('runs').replaceChildren(head, ...list.map(run => {
      const row = make('tr'), box = make('input', undefined, { type: 'checkbox', 'aria-label': 'maneuver ' + run.number }), cell = make('td');
      box.checked = chosen.includes(id(run));
      box.onchange = () => { row.className = box.checked ? 'chosen' : ''; choose(run, box.checked); };
      cell.append(box);
      row.append(cell, ...[`${run.campaign} ${run.number}${run.attempt > 1 ? ', attempt ' + run.attempt : ''}`, run.state, run.started, run.scenario,
        run.configuration.notes].map(t => make('td', t)));
      return row;
    }));
  };
  byId('note').onsubmit = async event => {
    event.preventDefault();
    try {
      const run = list.find(r => id(r) === chosen[chosen.length - 1]);
      say((await ask('note', { ...place(run), text: byId('note_text').value, who: byId('note_who').value }, true)).said);
      byId('note_text').value = '';
      await refresh();
      draw();
    } catch (error) {
      say(error.message, true);
    }
  };
  await refresh();
  // A campaign that runs has more by then.
  byId('tab_recorded').addEventListener('click', () => refresh().catch(error => say(error.message, true)));
}

// ---- what if

function whatIf() {
  const overlay = new Overlay(byId('what_if_charts'), 'stops'), form = byId('sliders');
  let kept = [], current = null, running = false, again = false;
  const values = () => Object.fromEntries(new FormData(form));
  const draw = () => {
    const runs = kept.concat(current || []);
    overlay.draw(runs);
    compare(byId('what_if_figures'), runs, ['figures']);
  };
  // One at a time; what was dragged meanwhile is run next.
  const run = async () => {
    again = running;
    if (running) return;
    running = true;
    try {
      const wanted = values();
      current = { ...await ask('stop', wanted), name: `${wanted.surface} ${wanted.law} ${wanted.slip}` };
      say('');
      draw();
    } catch (error) {
      say(error.message, true);
      if (error.status === 503) again = true;
      await new Promise(done => setTimeout(done, 100));
    }
    running = false;
    if (again) run();
  };
  for (const field of about.what_if) {
    const label = make('label', field.label + ' '), shown = make('b');
    const input = field.words ? make('select', undefined, { name: field.key })
      : make('input', undefined, { type: 'range', name: field.key, min: field.min, max: field.max, step: field.step });
    (field.words || []).forEach(word => input.append(make('option', word)));
    input.value = field.value;
    const told = () => { shown.textContent = field.words ? '' : input.value + ' ' + field.unit; };
    input[field.words ? 'onchange' : 'oninput'] = () => { told(); run(); };
    told();
    label.append(shown, input);
    form.append(label);
  }
  byId('keep').onclick = () => { if (current) kept.push(current); run(); };
  byId('forget').onclick = () => { kept = []; draw(); };
  run();
}

// ---- the page

async function start() {
  about = await ask('about');
  byId('title').textContent = document.title = about.title;
  byId('kind').textContent = about.simulated ? 'simulated: no rig moves' : '';
  byId('kind').className = about.simulated ? 'mark simulated' : 'mark';
  byId('stop_place').textContent = about.emergency_stop;
  show(byId('stop'), Boolean(about.emergency_stop));
  show(byId('no_charts'), typeof Dygraph === 'undefined');
  show(byId('token_row'), about.changes.length > 0);
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    byId('token').value = given;
    history.replaceState(null, '', location.pathname);
  }
  const views = { live: ['Live', live], recorded: ['Recorded', recorded], what_if: ['What if', whatIf] };
  const present = Object.keys(views).filter(name => about.views.includes(name)), opened = new Set();
  const open = async name => {
    for (const other of present) {
      show(byId(other), other === name);
      byId('tab_' + other).setAttribute('aria-selected', String(other === name));
    }
    if (opened.has(name)) return;
    opened.add(name);
    await views[name][1]();
  };
  for (const name of present) {
    const tab = make('button', views[name][0], { type: 'button', id: 'tab_' + name });
    tab.onclick = () => open(name).catch(error => say(error.message, true));
    byId('tabs').append(tab);
  }
  show(byId('tabs'), present.length > 1);
  await open(present[0]);
}

start().catch(error => say(error.message, true));
