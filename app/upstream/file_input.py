"""The size of an upload is limited on the server; panel-material-ui checks it in the browser alone.

What no button in a browser sends is ignored.

Reports to send upstream, versions and ends: docs/upstream/file_input.md
"""

from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary, ref

import panel_material_ui as pmui
from bokeh.document import Document
from panel import state


class LimitedFileInput(pmui.FileInput):
    """A `FileInput` that drops whatever exceeds `max_file_size` and says so through `refused`.

    Of the inputs of a page one receives at a time: an upload that another one begins takes the place of the first,
    so a browser that finishes none leaves one file at most.
    """

    def __init__(self, refused: Callable[[str], None], **params: Any) -> None:
        # What became of the file is said beside it: the button would say "Uploaded" of a refused one too.
        shipped: dict[str, Any] = {
            "uploaded_label": f"{params.get('label', 'File')}: {{filename}}",
            "sx": {
                "fontSize": "0.8125rem"
            },  # the words of a small button would stay as large as those of a large one
        }
        super().__init__(**shipped | params)
        self._refused = refused
        self._received = 0
        self._receiving = False

    def _handle_msg(self, msg: Any) -> None:
        if not self._is_step(msg):
            return
        status = msg["status"]
        if status == "error":  # the browser's own check
            self._refuse(str(msg.get("error", "the upload failed")))
            return
        if status == "initializing":
            self._drop()
            self._receive()
        elif status == "upload_event":
            if not self._receiving:
                return
            self._received += len(msg["data"])
            if self._received > self.max_file_size:
                self._file_buffer.clear()
                return
        elif status == "finished" and not 0 < self._received <= self.max_file_size:
            over = self._received > 0
            self._refuse(f"larger than {self.max_file_size / 1e6:.0f} MB" if over else "the file is empty")
            self._send_msg({"status": "error", "error": "not taken"})
            return
        super()._handle_msg(msg)

    def _is_step(self, msg: Any) -> bool:
        """True for a message that the button in the browser sends; the rest is ignored."""
        if not isinstance(msg, dict) or msg.get("status") != "upload_event":
            return isinstance(msg, dict) and msg.get("status") in ("error", "initializing", "finished")
        name, chunk, count = msg.get("name"), msg.get("chunk"), msg.get("total_chunks")
        if not (isinstance(name, str) and isinstance(msg.get("mime_type"), str)):
            return False
        if not (isinstance(chunk, int) and isinstance(count, int) and 1 <= chunk <= count):
            return False
        if name in self._file_buffer and self._file_buffer[name]["total_chunks"] != count:
            return False
        data: Any = msg.get("data")
        try:
            memoryview(data)
        except TypeError:
            return False
        return True

    def _receive(self) -> None:
        before = _receiving.get(state.curdoc, lambda: None)()
        if before is not None and before is not self and before._receiving:
            before._refuse("another file was chosen before it had arrived")
        _receiving[state.curdoc] = ref(self)
        self._receiving = True

    def _refuse(self, reason: str) -> None:
        self._drop()
        self._refused(reason)

    def _drop(self) -> None:
        self._receiving = False
        self._received = 0
        self._file_buffer.clear()
        self._buffer.clear()


_receiving: WeakKeyDictionary[Document, ref[LimitedFileInput]] = WeakKeyDictionary()
"""The input of each page whose upload began last."""
