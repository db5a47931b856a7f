// Browsers start no Worker of a page that is opened as a file. Search then runs in a hidden frame in its place.
// Zensical adds a script of another host for that, unless the name of one holds "iframe-worker".
if (location.protocol === "file:") {
  // As between threads: later, and a copy.
  const deliver = (message, receive) => {
    const data = structuredClone(message);
    setTimeout(() => receive({ data }));
  };

  window.Worker = class {
    constructor(url) {
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      this.waiting = [];
      this.inside = this.frame.contentWindow;
      this.inside.postMessage = (data) => deliver(data, (event) => this.onmessage?.(event));
      const script = this.frame.contentDocument.createElement("script");
      script.src = new URL(url, location.href);
      script.onerror = (event) => this.onerror?.(event);
      script.onload = () => {
        const waiting = this.waiting;
        this.waiting = null;
        waiting.forEach((data) => this.postMessage(data));
      };
      this.frame.contentDocument.body.append(script);
    }

    postMessage(data) {
      if (this.waiting) this.waiting.push(data);
      else deliver(data, (event) => this.inside.onmessage(event));
    }

    terminate() {
      this.frame.remove();
    }
  };
}
