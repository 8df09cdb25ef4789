"""The bodies of requests and answers, as HTTP and OpenAPI see them.

Requests are built from the library's documents. Answers are described here, and written elsewhere,
as bytes; tests hold the two together.
"""
