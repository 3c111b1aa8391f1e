// A proxy to the daemon. It can be interrupted, like a connection with a pulled cable or a terminated daemon.
import { once } from 'node:events';
import { connect, createServer } from 'node:net';

/** Listens on a free port and forwards everything to `base`. */
export async function proxyTo(base) {
	const { hostname, port } = new URL(base);
	const ends = new Set();
	const server = createServer((here) => {
		const there = connect(port, hostname);
		for (const end of [here, there]) {
			ends.add(end);
			end.on('error', () => {});
			end.on('close', () => {
				ends.delete(end);
				here.destroy();
				there.destroy();
			});
		}
		here.pipe(there).pipe(here);
	});
	const listen = async (at) => once(server.listen(at, '127.0.0.1'), 'listening');
	await listen(0);
	const own = server.address().port;
	return {
		base: `http://127.0.0.1:${own}`,
		async cut() {
			server.close();
			for (const end of ends) end.destroy();
		},
		restore: () => listen(own),
	};
}
