// Flies missions with the installed package for Node.js, and prints the hash of each last state.
//
//   node fly.mjs POLICY...

import assert from 'node:assert/strict';
import { about, fly } from 'jcas';

const offered = about();
assert.ok(offered.fields.some((field) => field.name === 'uav_count'));
assert.throws(() => fly({ policy: 'nobody', seed: 1 }), /^RangeError: policy = nobody: /);
for (const policy of process.argv.slice(2)) {
  assert.ok(offered.policies.includes(policy));
  const { state_hash, episode } = fly({ policy, seed: 7, config: { uav_count: 12 } });
  assert.equal(episode.header.config.uav_count, 12);
  console.log(state_hash);
}
