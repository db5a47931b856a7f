// The engine of `vitruvius watch`: a server on this machine, which watches the rule files.
// See page.js for what each member does. All addresses are relative, so they carry the page's token.

let grammar = "";
const ended = () => `The server has stopped: run vitruvius watch ${grammar} again, and open the address that it prints.`;

export const engine = {
  editable: false,
  briefs: true,

  open(onRules, onLost) {
    const events = new EventSource("events");
    events.addEventListener("rules", (event) => {
      const rules = JSON.parse(event.data);
      ({ grammar } = rules);
      onRules(rules);
    });
    events.addEventListener("error", () => {
      events.close();
      onLost(ended());
    });
  },

  async sheet(version, request, onPart, signal) {
    const response = await post("sheet", { version, request }, signal);
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const { done, value } = await there(reader.read());
      if (done) return;
      const lines = (rest + value).split("\n");
      rest = lines.pop();
      lines.forEach((line) => onPart(answered(JSON.parse(line))));
    }
  },

  async lint(version, signal) {
    return answered(await there((await post("lint", { version }, signal)).json()));
  },

  async why(version, house, part, signal) {
    return answered(await there((await post("why", { version, house, part }, signal)).json()));
  },
};

async function post(path, question, signal) {
  const response = await there(fetch(path, { method: "POST", body: JSON.stringify(question), signal }));
  if (!response.ok) throw new Error(await response.text());
  return response;
}

/** What the server sends; an Error that says so where there is no server any more. */
async function there(sent) {
  try {
    return await sent;
  } catch (error) {
    throw error.name === "AbortError" ? error : new Error(ended());
  }
}

/** An answer; an Error where it says why there is none. */
function answered(answer) {
  if (answer.error) throw new Error(answer.error);
  return answer;
}
