import signal
from threading import Thread

import pytest

from flexdepth.runtime.interrupts import interrupts_held


@pytest.fixture
def ctrl_c():
    """Python's own handler of Ctrl-C; a shell starts what runs in the background without one."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def swallow_one(after):
    with interrupts_held():
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            pytest.fail("it took effect inside the block")
        after.append("the block went on")


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_takes_effect_at_the_end_of_the_block():
    before, after = signal.getsignal(signal.SIGINT), []
    with pytest.raises(KeyboardInterrupt):
        swallow_one(after)
    assert after == ["the block went on"]
    assert signal.getsignal(signal.SIGINT) is before


def test_other_threads_go_on_as_ever():
    done = []

    def work():
        with interrupts_held():
            done.append(1)

    thread = Thread(target=work)
    thread.start()
    thread.join()
    assert done == [1]
