/* The theme puts the button that copies a block of code into a landmark of its own, without a name: there are many. */
const plain = () => document.querySelectorAll(".md-code__nav").forEach((nav) => nav.setAttribute("role", "presentation"));
new MutationObserver(plain).observe(document.documentElement, { childList: true, subtree: true });
plain();
