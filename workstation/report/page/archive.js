// Steps of the days, packed by page_data.cpp: zlib, base64, one block per day.
"use strict";

/** Bytes of a deflated base64 text. */
async function inflated(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/**
 * Days with their steps. Per step: minute (UTC, since 1970), localMinute (of the day),
 * contextClass, observed and paid (EUR/MWh); and for each policy profit (EUR), power (W, charge
 * positive), soc (0..1, before the step), action.
 */
async function unpackDays(archive) {
  const buffer = await inflated(archive.data);
  let at = 0;
  const take = (Type, count) => {
    const end = at + count * Type.BYTES_PER_ELEMENT;
    const values = new Type(buffer.slice(at, end));
    at = end;
    return values;
  };
  return archive.days.map(({date, steps}) => {
    const day = {date, steps, minute: take(Int32Array, steps)};
    day.observed = Float64Array.from(take(Int32Array, steps), (centi) => centi / 100);
    day.paid = Float64Array.from(take(Int32Array, steps), (milli) => milli / 1000);
    day.localMinute = take(Int16Array, steps);
    day.contextClass = take(Int8Array, steps);
    day.policies = archive.policies.map(() => ({
      profit: take(Float32Array, steps),
      power: take(Float32Array, steps),
      soc: Float64Array.from(take(Int16Array, steps), (e4) => e4 / 1e4),
      action: take(Int8Array, steps),
    }));
    return day;
  });
}

/** Running sum. */
function cumulative(values) {
  let sum = 0;
  return Array.from(values, (value) => (sum += value));
}
