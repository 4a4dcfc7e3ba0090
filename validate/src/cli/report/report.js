// The table of cells: sorted and filtered, its view in the fragment of the address. Rows are made as they
// are scrolled to, so that thousands of cells open at once.
'use strict';

(() => {
  const block = document.getElementById('cells-data');
  if (!block) return finish();
  const { columns, rows } = JSON.parse(block.textContent);
  const CHUNK = 150;
  const place = Object.fromEntries(columns.map((column, i) => [column.name, i]));
  const texts = rows.map((row) => row.map((value, i) => inWords(value, columns[i])).join(' ').toLowerCase());
  const head = document.querySelector('#cells-table thead');
  const body = document.querySelector('#cells-table tbody');
  const box = document.getElementById('cells-box');
  const filter = document.getElementById('filter');
  const choices = [...document.querySelectorAll('#filters select')];
  const shown = document.getElementById('shown');
  const view = { sort: '', down: false };
  let order = [];
  let made = 0;

  function inWords(value, column) {
    if (value === null || value === '') return '';
    if (column.kind === 'ratio') {
      const [ratio, low, high] = value;
      const digits = Math.max(ratio, high) < 9.995 ? 2 : 1;
      const text = (x) => x.toFixed(digits);
      return low === high ? text(ratio) : `${text(ratio)} [${text(low)}, ${text(high)}]`;
    }
    if (column.kind === 'number') return value.toLocaleString('en', { maximumSignificantDigits: 9 });
    return value;
  }

  // What a value is sorted by; a missing one has none.
  function key(value, column) {
    if (value === null || value === '') return null;
    return column.kind === 'ratio' ? value[0] : value;
  }

  // Sizes such as 64x64 and 512x512 go by their numbers.
  const words = new Intl.Collator('en', { numeric: true });

  function compare(a, b, column) {
    const i = place[column.name];
    const [x, y] = [key(rows[a][i], column), key(rows[b][i], column)];
    if (x === null || y === null) return (x === null) - (y === null) || a - b;
    const by = column.kind === 'text' ? words.compare(x, y) : x - y;
    return (view.down ? -by : by) || a - b;
  }

  function makeHead() {
    const row = head.insertRow();
    for (const column of columns) {
      const cell = document.createElement('th');
      cell.scope = 'col';
      if (column.kind !== 'text') cell.className = 'n';
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = column.title;
      button.addEventListener('click', () => {
        view.down = view.sort === column.name && !view.down;
        view.sort = column.name;
        remember();
        show();
      });
      cell.append(button);
      row.append(cell);
    }
  }

  function makeChoices() {
    for (const select of choices) {
      const i = place[select.dataset.column];
      const values = [...new Set(rows.map((row) => row[i]))].sort(words.compare);
      for (const value of values) select.add(new Option(value, value));
    }
  }

  function makeRows() {
    const part = document.createDocumentFragment();
    for (const r of order.slice(made, made + CHUNK)) {
      const row = document.createElement('tr');
      columns.forEach((column, i) => {
        const cell = row.insertCell();
        cell.textContent = inWords(rows[r][i], column);
        if (column.kind !== 'text') cell.className = 'n';
        if (isBad(column, rows[r][i])) cell.classList.add('bad');
      });
      part.append(row);
    }
    made = Math.min(made + CHUNK, order.length);
    body.append(part);
  }

  // Wrong rays, and ratios whose whole interval is below 1; of one repeat there is no interval.
  function isBad(column, value) {
    if (value === null) return false;
    return column.kind === 'ratio' ? value[1] < value[2] && value[2] < 1 : column.name === 'wrong' && value > 0;
  }

  function show() {
    const wanted = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const chosen = choices.filter((select) => select.value).map((select) => [place[select.dataset.column], select.value]);
    order = [];
    for (let r = 0; r < rows.length; r++) {
      if (wanted.every((word) => texts[r].includes(word)) && chosen.every(([i, value]) => rows[r][i] === value)) order.push(r);
    }
    const column = columns[place[view.sort]];
    if (column) order.sort((a, b) => compare(a, b, column));
    [...head.rows[0].cells].forEach((cell, i) => {
      if (columns[i] !== column) cell.removeAttribute('aria-sort');
      else cell.setAttribute('aria-sort', view.down ? 'descending' : 'ascending');
    });
    shown.textContent = `${order.length.toLocaleString('en')} of ${rows.length.toLocaleString('en')} cells`;
    body.replaceChildren();
    made = 0;
    box.scrollTop = 0;
    makeRows();
  }

  function remember() {
    const parts = new URLSearchParams();
    if (view.sort) parts.set('sort', (view.down ? '-' : '') + view.sort);
    if (filter.value.trim()) parts.set('filter', filter.value.trim());
    for (const select of choices) if (select.value) parts.set(select.dataset.column, select.value);
    history.replaceState(null, '', '#' + (parts.toString() || 'cells'));
  }

  // Takes the view from the fragment, if there is one in it; says whether.
  function recall() {
    const fragment = location.hash.slice(1);
    if (!fragment.includes('=')) return false;
    const parts = new URLSearchParams(fragment);
    const sort = parts.get('sort') || '';
    view.down = sort.startsWith('-');
    view.sort = sort.replace(/^-/, '');
    filter.value = parts.get('filter') || '';
    for (const select of choices) select.value = parts.get(select.dataset.column) || '';
    return true;
  }

  makeHead();
  makeChoices();
  const named = recall();
  show();
  if (named) document.getElementById('cells').scrollIntoView();
  filter.addEventListener('input', () => { remember(); show(); });
  choices.forEach((select) => select.addEventListener('change', () => { remember(); show(); }));
  document.getElementById('filters').addEventListener('submit', (event) => event.preventDefault());
  document.getElementById('filters').addEventListener('reset', () => setTimeout(() => {
    view.sort = '';
    remember();
    show();
  }));
  box.addEventListener('scroll', () => {
    if (box.scrollTop + 2 * box.clientHeight > box.scrollHeight && made < order.length) makeRows();
  });
  addEventListener('hashchange', () => { if (recall()) { show(); document.getElementById('cells').scrollIntoView(); } });
  addEventListener('beforeprint', () => { while (made < order.length) makeRows(); });
  finish();

  // Milliseconds from the start of loading until all is laid out.
  function finish() {
    void document.body.offsetHeight;
    document.documentElement.dataset.openMs = Math.round(performance.now());
  }
})();
