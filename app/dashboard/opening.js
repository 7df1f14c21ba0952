// Told before the page connects: which tab its address names, and what the browser is. The server makes the page by it.
{
  const dark = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"
  const narrow = innerWidth < 900 ? "narrow" : "wide"
  const page = location.hash.slice(1).toLowerCase().replace(/[^a-z].*$/, "")
  document.cookie = `COOKIE=${dark}.${narrow}.${page}; path=/; max-age=60; samesite=lax`
  if (dark === "dark" && !/THEME=/.test(document.cookie)) document.documentElement.style.colorScheme = "dark"
}
