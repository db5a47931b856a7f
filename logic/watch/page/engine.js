// The engine of `vitruvius watch`: a server on this machine, which watches the rule files.
// See page.js for what each member does. All addresses are relative, so they carry the page's token.

export const engine = {
  editable: false,

  open(onRules, onLost) {
    const events = new EventSource("events");
    events.addEventListener("rules", (event) => onRules(JSON.parse(event.data)));
    events.addEventListener("error", () => {
      events.close();
      onLost("vitruvius watch has ended: start it again, and open the address that it prints.");
    });
  },

  async sheet(version, request, onPart, signal) {
    const response = await post("sheet", { version, request }, signal);
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      const lines = (rest + value).split("\n");
      rest = lines.pop();
      lines.forEach((line) => onPart(answered(JSON.parse(line))));
    }
  },

  async lint(version, signal) {
    return answered(await (await post("lint", { version }, signal)).json());
  },

  async why(version, house, part, signal) {
    return answered(await (await post("why", { version, house, part }, signal)).json());
  },
};

async function post(path, question, signal) {
  const response = await fetch(path, { method: "POST", body: JSON.stringify(question), signal });
  if (!response.ok) throw new Error(await response.text());
  return response;
}

/** An answer; an Error where it says why there is none. */
function answered(answer) {
  if (answer.error) throw new Error(answer.error);
  return answer;
}
