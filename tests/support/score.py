"""The score of a test case that checks many things: counts, prints, goes on."""


class Score:
    def __init__(self):
        self.checks = self.failed = 0

    def expect(self, what, good, detail=""):
        self.checks += 1
        self.failed += not good
        print(f"{'ok  ' if good else 'FAIL'} {what} {detail if not good else ''}", flush=True)

    def status(self):
        """Says how it went; the exit status. A case that checked nothing has failed."""
        print(f"{self.checks - self.failed} passed, {self.failed} failed")
        return 0 if self.checks and not self.failed else 1
