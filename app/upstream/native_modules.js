// Panel has a shim fetch, read and rewrite every module, the component library's 1.4 MB among them, for the sake of
// import maps, which name a host elsewhere. The browser imports them as they are, and knows no such host.
//
// Written for: Panel 1.9.4
// Upstream: none found, searched 2026-11-22
// Needless when: tests/browser/test_as_shipped.py::test_modules_are_fetched_and_rewritten_and_ours_imported_by_the_browser fails
{
  const native = (url) => import(url)
  native.addImportMap = () => {}
  Object.defineProperty(window, "importShim", { get: () => native, set: () => {} })
}
