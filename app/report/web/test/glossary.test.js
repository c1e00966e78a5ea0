import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';

import {Glossary} from '../src/glossary.js';

const small = new Glossary([
  {term: 'band', also: ['95 % band'], means: 'B'},
  {term: 'gain', also: ['steady gain'], means: 'G'},
]);
const program = new Glossary(JSON.parse(readFileSync(new URL('../terms.json', import.meta.url), 'utf8')));

test('a heading has its meaning with any unit', () => {
  assert.equal(small.meaningOf('Band [rad/s]'), 'B');
  assert.equal(small.meaningOf('steady gain wz per velL [1/s]'), 'G');
  assert.equal(small.meaningOf('Run'), null);
});

test('case matters where two terms differ by it', () => {
  assert.match(program.meaningOf('Q'), /covariance/);
  assert.match(program.meaningOf('q'), /parameters/);
});
