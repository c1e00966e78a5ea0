import assert from 'node:assert/strict';
import {test} from 'node:test';

import {WindowCloud} from '../src/window_cloud.js';

// Four windows of a model with two parameters and one other feature. Two windows belong to component 1.
function cloudOf(windows = {}, arrays = {}) {
  const identity = [[1, 0], [0, 1]];
  const axes = [{name: 'A', unit: ''}, {name: 'B', unit: '1/s'}, {name: 'log q', unit: ''}];
  return new WindowCloud(
      {
        axes,
        parameters: 2,
        default_axes: [0, 1, 2],
        components: {features: ['B', 'A'], list: [{mean: [10, 20], covariance: [[4, 1], [1, 9]]}, {mean: [0, 0]}]},
        bank: [{mean: [1, 2], covariance: identity}],
        ...windows,
      },
      {
        values: [Float32Array.of(1, 2, 3, 4), Float32Array.of(5, 6, 7, 80), new Float32Array(4)],
        label: Int32Array.of(1, -1, 1, 0),
        mode: null,
        ...arrays,
      });
}

test('groups come in order, windows without one first', () => {
  assert.deepEqual(cloudOf().groups(), [[-1, [1]], [0, [3]], [1, [0, 2]]]);
  assert.deepEqual(cloudOf({}, {label: null}).groups(), [[-1, [0, 1, 2, 3]]]);
  assert.equal(cloudOf().groupName(-1), 'not clustered');
  assert.equal(cloudOf({}, {label: null}).groupName(-1), 'windows');
});

test('windows without a group are drawn first, then wide groups before narrow ones; hidden ones are not', () => {
  const cloud = cloudOf();
  assert.deepEqual(cloud.shownGroups([0, 1]).map(({key}) => key), [-1, 1, 0]);
  cloud.hidden.add(1);
  assert.deepEqual(cloud.shownGroups([0, 1]).map(({key}) => key), [-1, 0]);
});

test('ellipses of components follow the axes, whatever order the features have', () => {
  const cloud = cloudOf();
  assert.deepEqual(cloud.ellipses([0, 1]), [{k: 0, mean: [20, 10], covariance: [[9, 1], [1, 4]]}]);
  assert.deepEqual(cloud.ellipses([0, 2]), []);  // the mixture does not have this feature
});
