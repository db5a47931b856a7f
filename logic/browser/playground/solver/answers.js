/** The answers that are no house. */

/** Proved: no house satisfies the request. `unfurnishable`: types of room that cannot have their furniture. */
export class Unsatisfiable extends Error {
  constructor(unfurnishable) {
    super("no house satisfies the request");
    this.unfurnishable = unfurnishable;
  }
}

/** The budget ran out before a house or a proof. */
export class LimitReached extends Error {}

/** What is asked for cannot be: a name that the grammar does not have. */
export class RequestError extends Error {}
