// The button that switches between the system's colours, light and dark.
"use strict";

const themes = ["system", "light", "dark"];
const themeButton = document.querySelector(".theme");

function showTheme(theme) {
  if (theme === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  themeButton.textContent = `Colours: ${theme}`;
}

themeButton.hidden = false;
themeButton.addEventListener("click", () => {
  const now = document.documentElement.dataset.theme ?? "system";
  showTheme(themes[(themes.indexOf(now) + 1) % themes.length]);
});
showTheme("system");
