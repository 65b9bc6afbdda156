// Sets the stored theme before the first paint, then serves the switch in the header.
(() => {
  const KEY = "padstudio.theme";
  const root = document.documentElement;

  /** @returns {"auto" | "light" | "dark"} */
  function stored() {
    try {
      const value = localStorage.getItem(KEY);
      return value === "light" || value === "dark" ? value : "auto";
    } catch {
      return "auto"; // storage is forbidden: follow the system
    }
  }

  /** @param {string} theme */
  function apply(theme) {
    if (theme === "auto") root.removeAttribute("data-theme");
    else root.setAttribute("data-theme", theme);
    document.dispatchEvent(new CustomEvent("themechange"));
  }

  apply(stored());
  document.addEventListener("DOMContentLoaded", () => {
    const group = document.getElementById("theme-switch");
    const current = group?.querySelector(`input[value="${stored()}"]`);
    if (current instanceof HTMLInputElement) current.checked = true;
    group?.addEventListener("change", (event) => {
      const theme = /** @type {HTMLInputElement} */ (event.target).value;
      try {
        localStorage.setItem(KEY, theme);
      } catch {
        // Without storage the choice lasts for this page only.
      }
      apply(theme);
    });
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => apply(stored()));
})();
