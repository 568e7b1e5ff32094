"""examples/controller.py that goes wrong from step 100 to step 300: frozen, replay, nan or over."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))
from controller import Controller, command_t  # noqa: E402


class Bad:
    """A bus that spoils commands."""

    def __init__(self, bus, mode):
        self.bus, self.mode, self.said, self.frozen = bus, mode, [], None

    def __getattr__(self, name):
        return getattr(self.bus, name)

    def publish(self, channel, data):
        if channel == "COMMAND":
            command = command_t.decode(data)
            self.said.append(data)  # on a busy machine not one for every step
            if command.step < 100 or self.frozen is None:
                self.frozen = data
            if 100 <= command.step < 300:
                if self.mode == "frozen":
                    data = self.frozen
                elif self.mode == "replay":
                    data = self.said[-60:][0]
                else:
                    command.tau = [float("nan") if self.mode == "nan" else (-1e6 if command.step // 40 % 2 else 1e6)] * command.nv
                    data = command.encode()
        self.bus.publish(channel, data)


controller = Controller()
controller.bus = Bad(controller.bus, sys.argv[1])
controller.serve()
