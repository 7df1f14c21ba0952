export function render({ model }) {
  const keep = () => {
    const secure = location.protocol === "https:" ? "; secure" : ""
    const how = `; path=/; max-age=${model.text ? 31536000 : 0}; samesite=lax${secure}`
    document.cookie = `${model.key}=${encodeURIComponent(model.text)}${how}`
  }
  model.on("text", keep)
  if (model.text) keep()
  return document.createElement("span")
}
