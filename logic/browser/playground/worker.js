// Both solvers, in a worker: the page stays quick, and ends them by ending it. Not a module, as swipl-web.js is none.
//
// Asked { id, grammar, files, request }, it answers { id, begun }, { id, part } for each part of the sheet, then { id, done }
// or { id, error }; { loaded }, how many bytes of the solvers have come; { unloaded }, why there are none. A newer
// question ends an older one between two houses.

importScripts("swipl/swipl-web.js");

let newest = 0;
const ready = load();

async function load() {
  const [{ Clingo }, { Prolog }, { Houses }, { default: factory }] = await Promise.all(
    ["./solver/program.js", "./solver/prolog.js", "./solver/houses.js", "./clingo/clingo.js"].map((path) => import(path)));
  const [bundle, script, json] = await Promise.all(
    [text("rules.json").then(JSON.parse), text("solver/program.lua"), text("solver/json.pl")]);
  const [asp, prolog, library] = await Promise.all(Object.keys(bundle.bytes).map(counted));
  const [clingoCode, swiplCode] = await Promise.all([asp, prolog].map((bytes) => WebAssembly.compile(bytes)));
  const clingo = new Clingo((options) => factory({ ...options, ...running(clingoCode) }), script, bundle.says.syntax);
  const said = [];
  const [swipl] = await Promise.all([
    SWIPL({
      arguments: ["-q"],
      locateFile: (name) => `swipl/${name}`,
      ...running(swiplCode),
      getPreloadedPackage: () => library.buffer,
      print: (line) => said.push(line),
      printErr: (line) => said.push(line),
    }),
    clingo.load(),
  ]);
  const core = Object.entries(bundle.rules).filter(([path]) => path.endsWith(".pl"));
  return new Houses(bundle, clingo, new Prolog(swipl, Object.fromEntries(core), json));
}

async function fetched(path) {
  const response = await fetch(path);
  if (!response.ok) throw new Error(`${path} cannot be read: ${response.status} ${response.statusText}`);
  return response;
}

const text = async (path) => (await fetched(path)).text();

/** The option of Emscripten's factories that runs this code, in place of fetching it again. */
const running = (code) => ({
  instantiateWasm(imports, onReady) {
    WebAssembly.instantiate(code, imports).then(
      (instance) => onReady(instance, code), ({ message }) => postMessage({ unloaded: message }));
    return {};
  },
});

let loaded = 0;

/** A file's bytes. The page is told of each chunk, unpacked, whatever the server sends. */
async function counted(path) {
  const chunks = [];
  for (const reader = (await fetched(path)).body.getReader();;) {
    const { done, value } = await reader.read();
    if (done) return new Uint8Array(await new Blob(chunks).arrayBuffer());
    chunks.push(value);
    postMessage({ loaded: (loaded += value.length) });
  }
}

/** Messages that have come meanwhile are taken. */
const pause = () => new Promise((go) => {
  const channel = new MessageChannel();
  channel.port1.onmessage = go;
  channel.port2.postMessage(0);
});

onmessage = async ({ data: { id, grammar, files, request } }) => {
  newest = id;
  try {
    const houses = await ready.catch(({ message }) => postMessage({ unloaded: message }));
    if (!houses) return;
    await pause();
    if (id !== newest) return;
    postMessage({ id, begun: true });
    for await (const part of houses.sheet(files, grammar, request)) {
      postMessage({ id, part });
      await pause();
      if (id !== newest) return;
    }
    postMessage({ id, done: true });
  } catch (error) {
    postMessage({ id, error: error.message });
  }
};
