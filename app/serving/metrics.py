"""Metrics of the server in Prometheus' format."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from prometheus_client import CollectorRegistry, ProcessCollector, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from tornado.web import RequestHandler

from app.serving.board import SharedMetrics
from app.serving.rules import Rules, is_loopback

_FORWARDED = ("Forwarded", "X-Forwarded-For", "X-Real-Ip")
_Families = tuple[tuple[type[Metric], str, str, str], ...]
_TOTALS: _Families = (
    (GaugeMetricFamily, "navbudget_sessions", "Sessions open now.", "sessions"),
    (CounterMetricFamily, "navbudget_sessions_opened", "Sessions opened.", "opened"),
    (CounterMetricFamily, "navbudget_sessions_refused", "Visitors turned away: the server was full.", "refused"),
    (CounterMetricFamily, "navbudget_events", "Budgets computed for a change.", "events"),
    (GaugeMetricFamily, "navbudget_heavy_tasks", "Heavy tasks waiting or running.", "heavy"),
)
_OF_EACH: _Families = (
    (GaugeMetricFamily, "navbudget_process_sessions", "Sessions open now.", "sessions"),
    (GaugeMetricFamily, "navbudget_process_up", "1 while it serves pages.", "ready"),
    (CounterMetricFamily, "navbudget_process_restarts", "Times it was started again.", "restarts"),
)
"""Kind, name, help and column on the board: of sums over the processes, and of each process."""


class ServerMetrics(Collector):
    """All metrics: sums over the processes, and the resources of each."""

    def __init__(self, board: SharedMetrics, most_sessions: int, uptime: Callable[[], float]) -> None:
        self._board, self._most, self._uptime = board, most_sessions, uptime

    def text(self) -> bytes:
        """All metrics in the text format of Prometheus."""
        registry = CollectorRegistry(auto_describe=False)
        registry.register(self)
        return generate_latest(registry)

    def collect(self) -> Iterator[Metric]:
        """Every family of metrics, sums before those of each process."""
        for kind, name, text, column in _TOTALS:
            yield kind(name, text, value=self._board.total(column))  # type: ignore[call-arg]
        yield GaugeMetricFamily("navbudget_sessions_limit", "Sessions allowed at once.", value=self._most)
        yield GaugeMetricFamily("navbudget_uptime_seconds", "Seconds since the server began.", value=self._uptime())
        for kind, name, text, column in _OF_EACH:
            family = kind(name, text, labels=["process"])  # type: ignore[call-arg]
            for process in range(self._board.processes):
                family.add_metric([str(process)], self._board.get(process, column))  # type: ignore[attr-defined]
            yield family
        yield from self._of_the_machine()

    def _of_the_machine(self) -> Iterator[Metric]:
        """Memory, processor time and open files of each process that serves pages."""
        families: dict[str, Metric] = {}
        for process in range(self._board.processes):
            pid = self._board.get(process, "pid")
            for m in ProcessCollector(pid=partial(int, pid), registry=None).collect() if pid else ():
                family = families.setdefault(m.name, Metric(m.name, m.documentation, m.type))
                for sample in m.samples:
                    family.add_sample(sample.name, {**sample.labels, "process": str(process)}, sample.value)
        yield from families.values()


class MetricsHandler(RequestHandler):
    """Serves metrics to this machine and to logged-in users."""

    def initialize(self, metrics: ServerMetrics, rules: Rules) -> None:
        self._metrics, self._rules = metrics, rules

    def get(self) -> None:
        """Send the metrics, or say who may see them."""
        if not self._may_see():
            self.set_status(403)
            self.finish("metrics are open to this machine and to people who are logged in\n")
            return
        self.set_header("Content-Type", "text/plain; version=0.0.4; charset=utf-8")
        self.set_header("Cache-Control", "no-store")
        self.finish(self._metrics.text())

    def _may_see(self) -> bool:
        # Behind a proxy on this machine everybody seems to be here: a forwarded request is not from here.
        forwarded = any(name in self.request.headers for name in _FORWARDED)
        if is_loopback(self.request.remote_ip or "") and not forwarded:
            return True
        if self._rules.password_file is None:
            return False
        provider: Any = self.application.auth_provider  # type: ignore[attr-defined]  # Panel's application has one
        return provider.get_user(self) is not None
