// Buttons that copy a block of code, and wide drawings that show their middle first.
document.addEventListener("DOMContentLoaded", () => {
  for (const drawing of document.querySelectorAll(".drawing"))
    drawing.scrollLeft = (drawing.scrollWidth - drawing.clientWidth) / 2;
  if (!navigator.clipboard) return;
  for (const block of document.querySelectorAll("div.highlight")) {
    const button = document.createElement("button");
    button.className = "copy";
    button.type = "button";
    button.textContent = "Copy";
    button.addEventListener("click", async () => {
      await navigator.clipboard.writeText(block.querySelector("pre").textContent.trimEnd());
      button.textContent = "Copied";
      setTimeout(() => { button.textContent = "Copy"; }, 1500);
    });
    block.append(button);
  }
});
