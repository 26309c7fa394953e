from kurt2rt.channel.server.datagram_filter import TokenBucket
from tests.channel.clock import Clock


def taken(bucket: TokenBucket, tries: int) -> int:
    return sum(bucket.acquire() for _ in range(tries))


def test_new_tokens_come_at_its_rate() -> None:
    clock = Clock()
    bucket = TokenBucket(40, 10, clock)
    taken(bucket, tries=100)
    clock.now_s += 0.5
    assert taken(bucket, tries=100) == 5
