/** Which known name a misspelt one was meant to be: as logic/spelling.py. */

const ENOUGH = 0.65; // of the letters alike

/** The most similar name, of equally similar ones one that begins alike, and the one nearest in length; empty where none is. */
export function closest(name, names) {
  const measured = [...names].sort().map((other) => ({ other, likeness: [
    like(name.toLowerCase(), other.toLowerCase()), like(name, other), Number(name[0] === other[0]), -Math.abs(other.length - name.length),
  ] }));
  const [best] = measured.filter(({ likeness: [share] }) => share >= ENOUGH).sort((one, other) => {
    const place = one.likeness.findIndex((value, each) => value !== other.likeness[each]);
    return place < 0 ? 0 : other.likeness[place] - one.likeness[place];
  });
  return best?.other ?? "";
}

/** As in: there is no preset papre: did you mean paper? There are dqn, paper, pqn. */
export function unknown(what, name, names) {
  const near = closest(name, names);
  return `there is no ${what} ${name}${near ? `: did you mean ${near}? There are ` : ": there are "}${[...names].sort().join(", ")}`;
}

/** The share of letters in common runs (Ratcliff and Obershelp), from 0 to 1. */
const like = (one, other) => (2 * common(one, other)) / (one.length + other.length || 1);

/** How many letters the longest run in common has, and those before and behind it. */
function common(one, other) {
  let [length, i, j] = [0, 0, 0];
  for (let a = 0; a < one.length; a++)
    for (let b = 0; b < other.length; b++) {
      let size = 0;
      while (a + size < one.length && one[a + size] === other[b + size]) size++;
      if (size > length) [length, i, j] = [size, a, b];
    }
  if (!length) return 0;
  return length + common(one.slice(0, i), other.slice(0, j)) + common(one.slice(i + length), other.slice(j + length));
}
