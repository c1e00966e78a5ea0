import assert from 'node:assert/strict';
import test from 'node:test';

import {columns, nameOf, sentenceOf, ticked} from '../src/overview_rows.js';

const cells = (row) => Object.fromEntries(columns.map((column) => [column.name, column.of(row)]));

test('a row of an archive with a verdict', () => {
  const digest = {
    kind: 'run',
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
  const shown = cells({id: 'a', name: 'x.h5', folder: 'b', changed_s: 0, digest});
  assert.equal(shown.Name, 'b/x.h5');
  assert.equal(shown.Verdict, 'evidence');
  assert.deepEqual(shown['Gain [nats/sample]'], {v: 0.25, t: '0.250 ± 0.063'});
  assert.deepEqual(shown['In the 95 % band'], {v: 0.97, t: '97.0 %'});
  assert.equal(shown['Date (UTC)'], '2026-11-23 11:11');
  assert.equal(sentenceOf({digest}), 'They do.');
});

test('rows that say little', () => {
  const row = {id: 'a', name: 'x.h5', folder: '', changed_s: 60};
  assert.equal(nameOf(row), 'x.h5');
  assert.equal(cells(row).Verdict, 'being read');
  assert.equal(cells(row)['Date (UTC)'], '1970-01-01 00:01');
  assert.equal(cells({...row, problem: 'damaged'}).Verdict, 'not readable');
  assert.equal(sentenceOf({...row, problem: 'damaged'}), 'damaged');
  assert.equal(cells({...row, digest: {kind: 'study'}}).Verdict, 'study');
  assert.equal(cells({...row, digest: {kind: 'run'}})['Log score'], null);
});

test('two ticks at most', () => {
  assert.deepEqual(ticked(['a', 'b'], 'c', true), ['b', 'c']);
  assert.deepEqual(ticked(['a', 'b'], 'a', false), ['b']);
  assert.deepEqual(ticked(['a'], 'a', true), ['a']);
});
