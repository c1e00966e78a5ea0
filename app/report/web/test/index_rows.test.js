import assert from 'node:assert/strict';
import test from 'node:test';

import {addressOf, columns, compareCommand, sentenceOf} from '../src/index_rows.js';

const cells = (row) => Object.fromEntries(columns.map((column) => [column.name, column.of(row)]));

test('a row of an archive with a verdict', () => {
  const row = {
    kind: 'run',
    name: 'b/x.h5',
    created: '2026-11-23T11:11:27Z',
    data: 'ICE, 24 files',
    answer: 'evidence',
    text: 'They do.',
    modes: 3,
    gain: 0.25,
    standard_error: 0.0625,
    log_score: 2.4444,
    coverage_95: 0.97,
  };
  const shown = cells(row);
  assert.equal(shown.Name, 'b/x.h5');
  assert.equal(shown.Answer, 'evidence');
  assert.deepEqual(shown['Gain [nats/sample]'], {v: 0.25, t: '0.250 ± 0.063'});
  assert.deepEqual(shown['Log score'], {v: 2.4444, t: '2.44'});
  assert.deepEqual(shown['In the 95 % band'], {v: 0.97, t: '97.0 %'});
  assert.equal(shown['Date (UTC)'], '2026-11-23 11:11');
  assert.equal(sentenceOf(row), 'They do.');
});

test('rows that lack most cells', () => {
  const broken = {name: 'x.h5', problem: 'damaged'};
  assert.equal(cells(broken).Answer, 'not readable');
  assert.equal(cells(broken)['Date (UTC)'], null);
  assert.equal(sentenceOf(broken), 'damaged');
  assert.equal(cells({kind: 'study', name: 's'}).Answer, 'study');
  assert.equal(cells({kind: 'run', answer: null, log_score: null})['Log score'], null);
  assert.equal(cells({kind: 'run', answer: null}).Answer, 'none');
});

test('the address of a page with any name', () => {
  assert.equal(addressOf({page: 'pages/a #1?/100 %.html'}), 'pages/a%20%231%3F/100%20%25.html');
});

test('the command that compares is one for a shell', () => {
  const rows = [{name: 'a.h5', archive: '/r/a.h5'}, {name: 'o/b c.h5', archive: '/r/o\'s/b c.h5'}];
  assert.equal(compareCommand(rows), 'modebank report /r/a.h5 \'/r/o\'\\\'\'s/b c.h5\' -o \'a_b c.html\'');
});
